// Shared code of the widgets with their own JavaScript: the page's side of tutorial/notebook/widgets/cell_widget.py.

const LOST = new Set(["restarting", "autorestarting", "terminating", "dead"]);

/** Send a message to the kernel, unless the widget has been closed there. */
function send(model, message) {
  try {
    model.send(message);
  } catch (error) {
    console.debug("the widget is closed:", error);
  }
}

/**
 * Call onEnd when the kernel has ended or restarted, and onConnection when the connection to it is lost or restored.
 * Returns a function that stops these calls. Only JupyterLab gives widgets access to the kernel.
 */
function watchKernel(model, onEnd, onConnection) {
  const kernel = model.widget_manager?.kernel;
  let isConnected = true;
  const stop = () => {
    kernel?.statusChanged.disconnect(onStatus);
    kernel?.connectionStatusChanged.disconnect(onConnectionStatus);
    kernel?.disposed.disconnect(end);
  };
  const end = () => {
    stop();
    onEnd();
  };
  const onStatus = (_, status) => {
    if (LOST.has(status)) end();
  };
  const onConnectionStatus = (_, status) => {
    if (isConnected === (status === "connected")) return;
    isConnected = !isConnected;
    onConnection(isConnected);
  };
  kernel?.statusChanged.connect(onStatus);
  kernel?.connectionStatusChanged.connect(onConnectionStatus);
  kernel?.disposed.connect(end);
  return stop;
}

/**
 * One view of a widget that sends frames: the page's side of tutorial/notebook/widgets/frame_widget.py. A widget can
 * have several views, in several cells and on several pages. Subclasses implement `show` and extend the other handlers.
 */
class FrameView {
  static every = 1;  // acknowledge every n-th frame
  static patience = {first: 2000, most: 30000};  // between requests to the kernel [ms]
  static pulse = 60000;  // between signs of life [ms]

  constructor(model) {
    this.model = model;
    this.id = `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;
    this.isGone = false;  // the kernel has ended, or the view is disposed
    this.isShown = false;  // the whole content has arrived
    this.onMessage = this.onMessage.bind(this);
    this.onEnded = this.onEnded.bind(this);
    this.leave = () => this.say("bye");
    model.on("msg:custom", this.onMessage);
    model.on("change:ended", this.onEnded);
    window.addEventListener("pagehide", this.leave);
    this.pulse = setInterval(() => this.say("here"), FrameView.pulse);
    this.unwatch = watchKernel(model, () => this.onKernelEnd(), (isThere) => this.onConnection(isThere));
  }

  say(type, more = {}) {
    if (!this.isGone) send(this.model, {type, view: this.id, ...more});
  }

  /** Request the whole content until it arrives. */
  connect(patience = FrameView.patience.first) {
    clearTimeout(this.timer);
    if (this.isGone || this.isShown) return;
    this.ask();
    this.timer = setTimeout(() => this.connect(Math.min(2 * patience, FrameView.patience.most)), patience);
  }

  ask() {
    this.say("hello");
  }

  onMessage(message, buffers) {
    const {type, view, frame} = message;
    const isWhole = type === "whole" && view === this.id;
    if (!isWhole && !(type === "frame" && this.isShown)) return;
    this.isShown = true;
    this.show(message, buffers[0]);
    if (!isWhole && frame % this.constructor.every !== 0) return;
    // Acknowledge when the browser draws: a page that is slow or hidden receives fewer frames.
    requestAnimationFrame(() => this.say("seen", {frame}));
  }

  onConnection(isThere) {
    if (!isThere) return;
    this.isShown = false;
    this.connect();
  }

  onKernelEnd() {
    this.isGone = true;
    clearTimeout(this.timer);
    clearInterval(this.pulse);
    this.onEnded();
  }

  dispose() {
    this.leave();
    this.isGone = true;
    clearTimeout(this.timer);
    clearInterval(this.pulse);
    this.unwatch();
    this.model.off("msg:custom", this.onMessage);
    this.model.off("change:ended", this.onEnded);
    window.removeEventListener("pagehide", this.leave);
  }
}

/** The module's default export for a widget with this class of views. */
function showing(View) {
  return {
    render({model, el}) {
      const view = new View(model, el);
      return () => view.dispose();
    },
  };
}
