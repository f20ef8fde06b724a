// meshcat's viewer as one part of a page: in a notebook's cell, or in a replay. make.js, camera.js and scene.js precede
// this file in the same script.

const TURN = Math.PI / 36, ZOOM = 1.1;  // the angle [rad] and the factor of one key press
const KEYS = {
  ArrowLeft: [-TURN, 0, 1], ArrowRight: [TURN, 0, 1], ArrowUp: [0, -TURN, 1], ArrowDown: [0, TURN, 1],
  "+": [0, 0, 1 / ZOOM], "=": [0, 0, 1 / ZOOM], "-": [0, 0, ZOOM], "_": [0, 0, ZOOM],
};
/** The buttons in a picture, by the key that does the same. */
const TOOLS = {
  f: {name: "follow", title: "Keep the robot in the middle", act: ({camera}) => camera.follow(), isOn: ({camera}) => camera.followed},
  x: {name: "axes", title: "Show the frames: x red, y green, z blue", act: (picture) => picture.toggleAxes(), isOn: (picture) => picture.showsAxes},
  r: {name: "reset", title: "Put the camera back, as a double-click does", act: ({camera}) => camera.reset()},
};
const HINT = "drag or arrow keys: turn · scroll or + −: zoom · F: follow · X: axes · R: reset · Esc: leave";
const TAKEN = ["The browser has dropped this 3D view.", "It does so when a page has too many. Reload the page."];

/** The state of meshcat's script, which all views of a page share. */
function library() {
  const name = Symbol.for("tank-tutorial meshcat");
  if (!window[name]) {
    const shared = window[name] = {isTaken: false};
    shared.ready = new Promise((resolve, reject) => Object.assign(shared, {resolve, reject}));
    shared.ready.catch(() => {});
  }
  return window[name];
}

/** Run the script inside a function: with an AMD loader in the page, it would otherwise not define `MeshCat`. */
async function run(zipped) {
  const unzipped = new Blob([zipped]).stream().pipeThrough(new DecompressionStream("gzip"));
  const parts = ["(function (define, exports, module) {", await new Response(unzipped).blob(), "\n}).call(window);"];
  const source = URL.createObjectURL(new Blob(parts, {type: "text/javascript"}));
  await new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.onload = resolve;
    script.onerror = () => reject(new Error("the page does not allow it to run"));
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

/** Make something, and return it with a function that removes the window listeners that were added in the process. */
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

/** Make the element that contains a picture, within a frame. It has the description for screen readers. */
function makePane(title) {
  return make("div", "tank-view-pane", {
    "role": "img", "tabindex": "0", "data-lm-suppress-shortcuts": "true", "aria-label": `${title}, in 3D`,
    "aria-description": "The arrow keys turn it, plus and minus zoom, F follows the robot, X shows the frames' axes, R resets it, Escape leaves it.",
  });
}

/** A meshcat viewer that draws only while it can be seen, and that can be disposed of. */
class Picture {
  constructor(element, onTaken) {
    let isSeen = true;
    const [[viewer, stop], forget] = withoutTrace(() => makeViewer(element, () => isSeen));
    this.viewer = viewer;
    this.camera = new Camera(viewer);
    viewer.gui.domElement.remove();  // it is for developers, and covers part of the picture
    const canvas = viewer.renderer.domElement;
    canvas.addEventListener("webglcontextlost", onTaken);
    const unfit = fit(viewer, element);
    const observer = new IntersectionObserver((entries) => {
      isSeen = entries.at(-1).isIntersecting;
      if (isSeen) viewer.set_dirty();
    });
    observer.observe(element);
    const listening = new AbortController();
    this.listen(element, listening.signal);
    const hint = make("div", "tank-view-hint", {"aria-hidden": "true"}, HINT);
    const tools = this.makeTools(element);
    element.after(hint, tools);
    this.dispose = () => {
      listening.abort();
      hint.remove();
      tools.remove();
      canvas.removeEventListener("webglcontextlost", onTaken);
      observer.disconnect();
      unfit();
      viewer.set_3d_pane_size = () => {};
      viewer.controls.dispose();
      viewer.scene_tree.dispose_recursive();
      viewer.gui.destroy();
      stop();
      forget();
      canvas.remove();
    };
  }

  /** While the pane has the focus, it handles keys and the wheel. */
  listen(pane, signal) {
    pane.addEventListener("pointerdown", () => pane.focus({preventScroll: true}), {signal});
    pane.addEventListener("dblclick", () => this.use(TOOLS.r), {signal});
    pane.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      const tool = TOOLS[event.key.toLowerCase()];
      if (event.key === "Escape") pane.blur();
      else if (KEYS[event.key]) this.camera.turn(...KEYS[event.key]);
      else if (tool) this.use(tool);
      else return;
      event.preventDefault();
      event.stopPropagation();
    }, {signal});
    // The wheel scrolls the page past the view, unless the user has clicked into the view: then it zooms.
    pane.addEventListener("wheel", (event) => {
      if (!pane.contains(document.activeElement) && !event.ctrlKey) event.stopPropagation();
    }, {capture: true, passive: true, signal});
  }

  /** Make a button for each tool. A click moves the focus to the pane, so that keys work. */
  makeTools(pane) {
    const bar = make("div", "tank-view-tools");
    this.buttons = Object.entries(TOOLS).map(([key, tool]) => {
      const title = `${tool.title} (${key.toUpperCase()})`;
      const button = make("button", "", {type: "button", tabindex: "-1", title}, tool.name);
      button.addEventListener("click", () => {
        pane.focus({preventScroll: true});
        this.use(tool);
      });
      bar.append(button);
      return [button, tool];
    });
    return bar;
  }

  use(tool) {
    tool.act(this);
    for (const [button, {isOn}] of this.buttons) if (isOn) button.setAttribute("aria-pressed", String(Boolean(isOn(this))));
  }

  get showsAxes() {
    return axesIn(this.viewer).some((path) => this.viewer.scene_tree.find(path).object.visible);
  }

  /** Hide the axes that are visible, or show all. */
  toggleAxes() {
    const isVisible = !this.showsAxes;
    for (const path of axesIn(this.viewer)) this.viewer.set_property(path, "visible", isVisible);
    this.viewer.set_dirty();
  }
}
