// Shows a scene in a notebook's cell: the page's side of tutorial/widgets/scene_view.py. cell.js and scene.js stand before
// this text in the same module.

const SEEN_EVERY = 10;  // frames; the kernel waits for 60
const PATIENCE = {first: 2000, most: 30000};  // until the kernel is asked once more [ms]
const TURN = Math.PI / 36, ZOOM = 1.1;  // a key press
const KEYS = {
  ArrowLeft: [-TURN, 0, 1], ArrowRight: [TURN, 0, 1], ArrowUp: [0, -TURN, 1], ArrowDown: [0, TURN, 1],
  "+": [0, 0, 1 / ZOOM], "=": [0, 0, 1 / ZOOM], "-": [0, 0, ZOOM], "_": [0, 0, ZOOM],
};

const WAITING = ["Connecting…", "If a cell is running, the picture appears when it is done."];
const ENDED = ["The kernel has ended or was restarted.", "Run the notebook's cells again, and the view comes back."];
const OFFLINE = ["The connection to Jupyter is lost.", "The picture goes on by itself when the connection is back."];
const NO_SCRIPT = "meshcat's viewer could not be started in this page.";
const NO_WEBGL = "This browser shows no 3D graphics.";
const TAKEN = ["The browser has taken the 3D graphics away.", "It does so when a page has too many. Reload the page."];

/** meshcat's viewer, a script that the whole page needs once, whoever gets it first. */
function library() {
  const name = Symbol.for("tank-tutorial meshcat");
  if (!window[name]) {
    const shared = window[name] = {isTaken: false};
    shared.ready = new Promise((resolve, reject) => Object.assign(shared, {resolve, reject}));
    shared.ready.catch(() => {});
  }
  return window[name];
}

/** Run the script. In a function of its own: where a page has an AMD loader, it would not define `MeshCat` otherwise. */
async function run(zipped) {
  const unzipped = new Blob([zipped]).stream().pipeThrough(new DecompressionStream("gzip"));
  const parts = ["(function (define, exports, module) {", await new Response(unzipped).blob(), "\n}).call(window);"];
  const source = URL.createObjectURL(new Blob(parts, {type: "text/javascript"}));
  await new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.onload = resolve;
    script.onerror = () => reject(new Error("the page does not let it run"));
    script.src = source;
    document.head.append(script);
  });
  URL.revokeObjectURL(source);
  if (!window.MeshCat) throw new Error("it does not define MeshCat");
}

function takeLibrary(zipped) {
  const shared = library();
  if (shared.isTaken) return;
  shared.isTaken = true;
  run(zipped).then(shared.resolve, shared.reject);
}

/** Make something, and return it with a function that takes off the window what was put there meanwhile. */
function withoutTrace(make) {
  const add = window.addEventListener, {onload} = window, put = [];
  window.addEventListener = (...listener) => {
    put.push(listener);
    add.apply(window, listener);
  };
  try {
    return [make(), () => put.forEach((listener) => window.removeEventListener(...listener))];
  } finally {
    delete window.addEventListener;
    window.onload = onload;
  }
}

/** A meshcat viewer that draws only while it can be seen, and that can be disposed of. */
class Picture {
  constructor(element, onTaken) {
    const [viewer, forget] = withoutTrace(() => new MeshCat.Viewer(element, false));
    this.viewer = viewer;
    viewer.gui.domElement.remove();  // it is for those who draw, and hides a part of the picture
    const canvas = viewer.renderer.domElement;
    canvas.addEventListener("webglcontextlost", onTaken);
    const unfit = fit(viewer, element);
    let isSeen = true, request = 0;
    const observer = new IntersectionObserver(([{isIntersecting}]) => { isSeen = isIntersecting; });
    observer.observe(element);
    const draw = () => {
      request = requestAnimationFrame(draw);
      viewer.animator.update();
      if (isSeen && viewer.needs_render) viewer.render();
    };
    draw();
    this.dispose = () => {
      cancelAnimationFrame(request);
      canvas.removeEventListener("webglcontextlost", onTaken);
      observer.disconnect();
      unfit();
      viewer.set_3d_pane_size = () => {};
      viewer.controls.dispose();
      viewer.scene_tree.dispose_recursive();
      viewer.gui.destroy();
      viewer.renderer.dispose();
      viewer.renderer.forceContextLoss();  // a browser has 16 of them
      forget();
      canvas.remove();
    };
  }

  /** Turn the camera about what it looks at [rad], and multiply its distance. */
  turn(right, down, distance) {
    const {camera, controls} = this.viewer;
    const arm = camera.position.clone().sub(controls.target);
    const angles = new MeshCat.THREE.Spherical().setFromVector3(arm);
    angles.theta += right;
    angles.phi = Math.max(0.05, Math.min(angles.phi + down, Math.PI - 0.05));
    angles.radius = Math.max(0.1, Math.min(angles.radius * distance, 90));
    camera.position.setFromSpherical(angles).add(controls.target);
    this.viewer.set_dirty();
  }
}

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
      this.say(NO_WEBGL, `It has no WebGL, or WebGL is switched off. It says: ${error.message}`);
      return;
    }
    this.pane.viewer = this.picture.viewer;  // for the curious, in the browser's console
    this.reader = new SceneReader(this.picture.viewer, (text) => {
      this.line.textContent = text;
      this.line.hidden = text === "";
    });
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
