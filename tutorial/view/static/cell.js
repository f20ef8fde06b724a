// What the widgets with a page of their own have in common: the page's side of tutorial/notebook/widgets/cell_widget.py.

const LOST = new Set(["restarting", "autorestarting", "terminating", "dead"]);

/** Say something to the kernel, unless the widget has been closed there. */
function send(model, message) {
  try {
    model.send(message);
  } catch (error) {
    console.debug("the widget is closed:", error);
  }
}

/**
 * Tell when the kernel has ended, for good as far as its widgets go, and when the connection to it is lost or there again.
 * Returns how to stop. Only JupyterLab lets its widgets see the kernel.
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
 * One view of a widget that sends frames: the page's side of tutorial/notebook/widgets/frame_widget.py. A cell may be shown
 * twice, and a notebook on two pages. Those that extend it say how to `show` content, and what else happens at which moment.
 */
class FrameView {
  static every = 1;  // how many frames come for one answer
  static patience = {first: 2000, most: 30000};  // until the kernel is asked once more [ms]
  static pulse = 60000;  // between two words that the page is still here [ms]

  constructor(model) {
    this.model = model;
    this.id = `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;
    this.isGone = false;  // the kernel, and with it the widget; or the view
    this.isShown = false;  // the whole has come
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

  /** Ask for the whole until it has come. */
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
    // Not before the browser has come to draw it: a page that is slow, or not looked at, asks for less.
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

/** What a widget exports whose views are of a class. */
function showing(View) {
  return {
    render({model, el}) {
      const view = new View(model, el);
      return () => view.dispose();
    },
  };
}
