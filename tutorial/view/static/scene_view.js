// Shows a scene in a notebook's cell: the page's side of tutorial/notebook/widgets/scene_view.py. cell.js, scene.js and
// viewer.js stand before this text in the same module.

const SEEN_EVERY = 10;  // frames; the kernel waits for 60
const PATIENCE = {first: 2000, most: 30000};  // until the kernel is asked once more [ms]

const WAITING = ["Connecting…", "If a cell is running, the picture appears when it is done."];
const ENDED = ["The kernel has ended or was restarted.", "Run the notebook's cells again, and the view comes back."];
const OFFLINE = ["The connection to Jupyter is lost.", "The picture goes on by itself when the connection is back."];
const NO_SCRIPT = "meshcat's viewer could not be started in this page.";

/** One view of the widget: a cell may be shown twice, and a notebook on two pages. */
class CellView {
  constructor(model, el) {
    this.model = model;
    this.id = `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;
    this.isGone = false;  // the kernel, and with it the widget
    this.isShown = false;  // the scene
    this.build(el);
    this.onMessage = this.onMessage.bind(this);
    model.on("msg:custom", this.onMessage);
    this.unwatch = watchKernel(model, () => this.end(), (isThere) => this.onConnection(isThere));
    this.onEnded = () => { this.ended.hidden = !model.get("ended"); };
    model.on("change:ended", this.onEnded);
    this.onEnded();
    this.connect();
    library().ready.then(() => this.start(), (error) => this.say(NO_SCRIPT, `It says: ${error.message}`));
  }

  build(el) {
    const {model} = this;
    this.frame = make("div", "tank-view-frame");
    this.pane = make("div", "tank-view-pane", {
      "role": "img", "tabindex": "0", "data-lm-suppress-shortcuts": "true", "aria-label": `${model.get("title")}, in 3D`,
      "aria-description": "The arrow keys turn it, plus and minus zoom, Escape leaves it.",
    });
    this.pane.style.height = `${model.get("height")}px`;
    this.curtain = make("div", "tank-view-curtain", {role: "status"});
    this.curtain.append(make("strong", ""), make("span", ""));
    const hint = make("div", "tank-view-hint", {"aria-hidden": "true"});
    hint.textContent = "drag or arrow keys: turn · scroll or + −: zoom · Esc: leave";
    this.line = make("div", "tank-view-line");
    this.line.hidden = true;
    this.ended = make("div", "tank-view-ended", {role: "status"}, "closed: this is its last picture");
    this.frame.append(this.pane, hint, this.ended, this.curtain);
    const box = make("div", "tank-view");
    box.append(this.frame, this.line);
    el.append(box);
    this.say(...WAITING);
    this.listen();
  }

  listen() {
    const {pane} = this;
    pane.addEventListener("pointerdown", () => pane.focus({preventScroll: true}));
    pane.addEventListener("keydown", (event) => this.onKey(event));
    // Who scrolls the notebook past the view goes on scrolling; who has clicked into it zooms.
    pane.addEventListener("wheel", (event) => {
      if (!pane.contains(document.activeElement) && !event.ctrlKey) event.stopPropagation();
    }, {capture: true, passive: true});
    this.leave = () => this.send({type: "bye"});
    window.addEventListener("pagehide", this.leave);
  }

  say(title, hint) {
    const [strong, span] = this.curtain.children;
    strong.textContent = title;
    span.textContent = hint;
    this.curtain.hidden = false;
  }

  send(message) {
    if (!this.isGone) send(this.model, {...message, view: this.id});
  }

  /** Ask for what is missing, the script or the scene, until it has come. */
  connect(patience = PATIENCE.first) {
    clearTimeout(this.timer);
    if (this.isGone || this.isShown) return;
    if (this.picture) this.send({type: "hello"});
    else if (!library().isTaken && (library().askedAt ?? -Infinity) < performance.now() - PATIENCE.first / 2) {
      library().askedAt = performance.now();
      this.send({type: "library"});
    }
    this.timer = setTimeout(() => this.connect(Math.min(2 * patience, PATIENCE.most)), patience);
  }

  start() {
    if (this.isDisposed || this.isGone) return;
    try {
      this.picture = new Picture(this.pane, () => this.say(...TAKEN));
    } catch (error) {
      clearTimeout(this.timer);
      this.say(...noGraphics(error));
      return;
    }
    this.pane.viewer = this.picture.viewer;  // for the curious, in the browser's console
    this.reader = new SceneReader(this.picture.viewer, (text) => sayBelow(this.line, text));
    this.connect();
  }

  onMessage({type, view, frame}, buffers) {
    if (type === "library") takeLibrary(buffers[0]);
    if (!this.reader) return;
    if (type === "scene" && view === this.id) {
      this.isShown = true;
      this.reader.read(buffers[0]);
      this.curtain.hidden = true;
    } else if (type === "frame" && this.isShown) {
      this.reader.read(buffers[0]);
      if (frame % SEEN_EVERY === 0) this.send({type: "seen", frame});
    }
  }

  onKey(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === "Escape") this.pane.blur();
    else if (KEYS[event.key] && this.picture) this.picture.turn(...KEYS[event.key]);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  onConnection(isThere) {
    if (isThere) {
      this.isShown = false;
      this.connect();
    } else if (this.isShown) this.say(...OFFLINE);
  }

  end() {
    this.isGone = true;
    clearTimeout(this.timer);
    this.say(...ENDED);
  }

  dispose() {
    this.isDisposed = true;
    clearTimeout(this.timer);
    this.unwatch();
    this.model.off("msg:custom", this.onMessage);
    this.model.off("change:ended", this.onEnded);
    this.picture?.dispose();
    window.removeEventListener("pagehide", this.leave);
    this.leave();
  }
}

export default {
  render({model, el}) {
    const view = new CellView(model, el);
    return () => view.dispose();
  },
};
