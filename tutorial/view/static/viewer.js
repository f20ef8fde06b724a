// meshcat's viewer as one part of a page: in a notebook's cell, or in a replay. make.js and scene.js precede this file
// in the same script.

const TURN = Math.PI / 36, ZOOM = 1.1;  // a key press
const KEYS = {
  ArrowLeft: [-TURN, 0, 1], ArrowRight: [TURN, 0, 1], ArrowUp: [0, -TURN, 1], ArrowDown: [0, TURN, 1],
  "+": [0, 0, 1 / ZOOM], "=": [0, 0, 1 / ZOOM], "-": [0, 0, ZOOM], "_": [0, 0, ZOOM],
};
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

/** Make something, and return it with a function that removes the window's listeners that were added meanwhile. */
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

/** Make the element for a picture, with its description for screen readers. */
function makePane(title) {
  return make("div", "tank-view-pane", {
    "role": "img", "tabindex": "0", "data-lm-suppress-shortcuts": "true", "aria-label": `${title}, in 3D`,
    "aria-description": "The arrow keys turn it, plus and minus zoom, Escape leaves it.",
  });
}

/** While a pane has the focus, keys and the wheel are its own. getPicture: says what they turn, if it is there. */
function listenToKeys(pane, getPicture) {
  pane.addEventListener("pointerdown", () => pane.focus({preventScroll: true}));
  pane.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const picture = getPicture();
    if (event.key === "Escape") pane.blur();
    else if (KEYS[event.key] && picture) picture.turn(...KEYS[event.key]);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  // Who scrolls the page past the view goes on scrolling; who has clicked into it zooms.
  pane.addEventListener("wheel", (event) => {
    if (!pane.contains(document.activeElement) && !event.ctrlKey) event.stopPropagation();
  }, {capture: true, passive: true});
}

/** A meshcat viewer that draws only while it can be seen, and that can be disposed of. */
class Picture {
  constructor(element, onTaken) {
    let isSeen = true;
    const [[viewer, stop], forget] = withoutTrace(() => makeViewer(element, () => isSeen));
    this.viewer = viewer;
    viewer.gui.domElement.remove();  // it is for developers, and covers a part of the picture
    const canvas = viewer.renderer.domElement;
    canvas.addEventListener("webglcontextlost", onTaken);
    const unfit = fit(viewer, element);
    const observer = new IntersectionObserver((entries) => {
      isSeen = entries.at(-1).isIntersecting;
      if (isSeen) viewer.set_dirty();
    });
    observer.observe(element);
    this.dispose = () => {
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
