// Shows a scene in a notebook's cell: the page's side of tutorial/notebook/widgets/scene_view.py. The files
// of every view (VIEW in tutorial/view/assets.py) and cell.js precede this file in the same module.

const WAITING = ["Connecting…", "If a cell is running, the picture appears when the cell is done."];
const ENDED = ["The kernel has ended or was restarted.", "Run the notebook's cells again to get the view back."];
const OFFLINE = ["The connection to Jupyter is lost.", "The picture continues when the connection is back."];
const NO_SCRIPT = "meshcat's viewer could not start in this page.";

/**
 * Scroll until an element is on the screen, if part of it is there. JupyterLab scrolls to the next cell before the view
 * takes its place, so that the top of the view can be cut off.
 */
function reveal(element) {
  const onceSeen = ([{intersectionRatio}], observer) => {
    observer.disconnect();
    if (intersectionRatio > 0 && intersectionRatio < 1) element.scrollIntoView({block: "nearest"});
  };
  new IntersectionObserver(onceSeen).observe(element);
}

class CellView extends FrameView {
  static every = 10;  // the kernel sends up to 60 without an acknowledgement

  constructor(model, el) {
    super(model);
    this.build(el);
    this.onEnded();
    this.connect();
    library().ready.then(() => this.start(), (error) => this.raise(NO_SCRIPT, `The error was: ${error.message}`));
  }

  build(el) {
    const {model} = this;
    this.frame = make("div", "tank-view-frame");
    this.pane = makePane(model.get("title"));
    this.pane.style.height = "clamp(240px, 40vh, 420px)";  // so that the code that moves it is also visible
    this.curtain = make("div", "tank-view-curtain", {role: "status"});
    this.curtain.append(make("strong", ""), make("span", ""));
    this.line = make("div", "tank-view-line");
    this.line.hidden = true;
    this.ended = make("div", "tank-view-ended", {role: "status"}, "closed: this is its last picture");
    this.frame.append(this.pane, this.ended, this.curtain);
    const box = make("div", "tank-view");
    box.append(this.frame, this.line);
    el.append(box);
    this.raise(...WAITING);
  }

  raise(title, hint) {
    const [strong, span] = this.curtain.children;
    strong.textContent = title;
    span.textContent = hint;
    this.curtain.hidden = false;
  }

  /** Request what is missing: the script or the scene. */
  ask() {
    if (this.picture) super.ask();
    else if (!library().isTaken && (library().askedAt ?? -Infinity) < performance.now() - FrameView.patience.first / 2) {
      library().askedAt = performance.now();
      send(this.model, {type: "library"});
    }
  }

  start() {
    if (this.isGone) return;
    try {
      this.picture = new Picture(this.pane, () => this.raise(...TAKEN));
    } catch (error) {
      clearTimeout(this.timer);
      this.raise(...noGraphics(error));
      return;
    }
    this.pane.viewer = this.picture.viewer;  // for the curious, in the browser's console
    this.reader = new SceneReader(this.picture.viewer, (text) => sayBelow(this.line, text));
    this.connect();
  }

  onMessage(message, buffers) {
    if (message.type === "library") takeLibrary(buffers[0]);
    super.onMessage(message, buffers);
  }

  show(_, content) {
    this.reader.read(content);
    this.curtain.hidden = true;
    if (!this.isRevealed) reveal(this.frame);
    this.isRevealed = true;
  }

  onConnection(isThere) {
    if (!isThere && this.isShown) this.raise(...OFFLINE);
    super.onConnection(isThere);
  }

  onEnded() {
    if (this.isGone) this.raise(...ENDED);
    this.ended.hidden = !this.model.get("ended");
  }

  dispose() {
    super.dispose();
    this.picture?.dispose();
  }
}

export default showing(CellView);
