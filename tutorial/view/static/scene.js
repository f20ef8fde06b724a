// Feeds the messages of tutorial/view/scene.py to a meshcat viewer, in a page or in a notebook cell.

const COMMAND = 0, LINE = 1, CLEAR = 2, CAMERA = 3;  // as Record in tutorial/view/scene.py
const ONLY_ONCE = new Set(["Background", "Cameras"]);  // of what a viewer has to begin with, it can make all else anew

const BY_PROCESSOR = /swiftshader|llvmpipe|softpipe|software|basic render/i;  // what draws where there is no graphics card
const PAUSE = 100;  // between two pictures, there [ms]

/** What a page says where a viewer cannot be made: a title, and a hint. */
export const noGraphics = ({message}) =>
  ["This browser shows no 3D graphics.", `It has no WebGL, or WebGL is switched off. It says: ${message}`];

/** Whether a canvas is drawn by a graphics card. Some browsers don't say; then it is. */
function hasCard(gl) {
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  return !names || !BY_PROCESSOR.test(gl.getParameter(names.UNMASKED_RENDERER_WEBGL));
}

/**
 * A meshcat viewer in an element, which draws when something has changed. Where the processor has to draw, a third of the
 * work is left: no shadows, no smooth edges, and ten pictures a second. The simulation and the page need the processor, too.
 * isSeen: whether it is worth while. Returns the viewer, and how to let it go.
 */
export function makeViewer(element, isSeen = () => true) {
  const {WebGLRenderer, PCFSoftShadowMap} = MeshCat.THREE;
  let renderer = new WebGLRenderer({alpha: true});
  const isFast = hasCard(renderer.getContext());
  if (isFast) {
    release(renderer);
    renderer = new WebGLRenderer({alpha: true, antialias: true});
  }
  Object.assign(renderer.shadowMap, {enabled: isFast, type: PCFSoftShadowMap});
  element.append(renderer.domElement);
  const viewer = new MeshCat.Viewer(element, false, renderer);
  let request = 0, rest = 0;
  const ask = () => {
    if (!rest && viewer.needs_render && isSeen()) request ||= requestAnimationFrame(draw);
  };
  const draw = () => {
    request = 0;
    if (!isFast) rest = setTimeout(() => { rest = 0; ask(); }, PAUSE);
    viewer.render();
  };
  viewer.set_dirty = () => {
    viewer.needs_render = true;
    ask();
  };
  viewer.set_dirty();
  return [viewer, () => {
    viewer.set_dirty = () => {};
    cancelAnimationFrame(request);
    clearTimeout(rest);
    release(renderer);
  }];
}

/** Give a canvas's memory back: a browser has 16 of them. */
function release(renderer) {
  renderer.dispose();
  renderer.forceContextLoss();
}

/** Say below a view what a record LINE holds: a line, and a table's rows, with tabs between the cells. */
export function sayBelow(element, text) {
  const [line, ...rows] = text.split("\n");
  element.replaceChildren(line);
  element.hidden = text === "";
  if (!rows.length) return;
  const table = element.appendChild(document.createElement("table"));
  table.className = "tank-readings";
  for (const row of rows) {
    const cells = table.insertRow();
    for (const text of row.split("\t")) {
      const isHeading = cells.rowIndex === 0 || !cells.hasChildNodes();
      cells.appendChild(document.createElement(isHeading ? "th" : "td")).textContent = text;
    }
  }
}

/** The records of a message, as {kind, payload}. */
export function* records(message) {
  const view = message instanceof ArrayBuffer
    ? new DataView(message)
    : new DataView(message.buffer, message.byteOffset, message.byteLength);
  for (let start = 0; start < view.byteLength;) {
    const length = view.getUint32(start, true);
    const kind = view.getUint8(start + 4);
    yield {kind, payload: new Uint8Array(view.buffer, view.byteOffset + start + 5, length)};
    start += 5 + length;
  }
}

/**
 * Let a viewer replace a light as often as one likes. meshcat takes a light's controls off the page, but not off its list:
 * from the third light on, it takes them off once more, which the browser refuses. The light's map of shadows it forgets.
 */
function mend(viewer) {
  const replace = viewer.set_object.bind(viewer);
  viewer.set_object = (path, object) => {
    const node = viewer.scene_tree.find([...path, "<object>"]);
    letGo(node);
    for (const control of node.controllers.splice(0)) node.folder.remove(control);
    replace(path, object);
  };
}

/** Give back what meshcat forgets about when it disposes of a part of the scene. */
function letGo({object}) {
  object.traverse((each) => { if (each.isLight) each.dispose(); });
}

/** Shows the messages of one scene. */
export class SceneReader {
  /** viewer: a MeshCat.Viewer. showLine: called with the text of the line under the view. */
  constructor(viewer, showLine) {
    this.viewer = viewer;
    this.showLine = showLine;
    this.camera = "";
    const {top_color, bottom_color, visible} = viewer.scene_tree.find(["Background"]).object;
    this.sky = {top_color, bottom_color, visible};
    mend(viewer);
  }

  /** message: an ArrayBuffer, a DataView or a Uint8Array. */
  read(message) {
    let isWhole = false;
    for (const {kind, payload} of records(message)) {
      try {
        if (kind === CLEAR) { isWhole = true; this.clear(); }
        else if (kind === COMMAND) this.viewer.handle_command_bytearray(payload);
        else if (kind === LINE) this.showLine(new TextDecoder().decode(payload));
        else if (kind === CAMERA) this.place(payload, isWhole);
      } catch (error) {  // one bad record does not cost the others
        console.error("a record of kind", kind, "cannot be shown:", error);
      }
    }
  }

  /** Make everything as it was in the beginning, but for the camera, which somebody may have turned by hand. */
  clear() {
    const {viewer} = this;
    for (const [name, node] of Object.entries(viewer.scene_tree.children)) {
      if (ONLY_ONCE.has(name)) continue;
      letGo(node);
      viewer.delete_path([name]);
    }
    viewer.add_default_scene_elements();
    Object.assign(viewer.scene_tree.find(["Background"]).object, this.sky);
    viewer.scene.background?.dispose();
    viewer.show_background();
    this.showLine("");
    viewer.set_dirty();
  }

  // A view turned by hand stays so when the same scene is shown once more.
  place(payload, isWhole) {
    if (isWhole && this.camera === payload.join()) return;
    this.camera = payload.join();
    const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
    const [x, y, z, toX, toY, toZ] = [0, 8, 16, 24, 32, 40].map((start) => view.getFloat64(start, true));
    const {viewer} = this;
    viewer.set_transform(["Cameras", "default"], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    viewer.camera.position.set(x, z, -y);  // three.js: y is up
    viewer.controls.target.set(toX, toZ, -toY);
    viewer.set_dirty();
  }
}

/** Keep the picture as large as its element; meshcat itself takes the height of the window. Returns how to stop. */
export function fit(viewer, element) {
  const resize = viewer.set_3d_pane_size.bind(viewer);
  viewer.set_3d_pane_size = () => {
    if (element.clientWidth && element.clientHeight) resize(element.clientWidth, element.clientHeight);
  };
  const observer = new ResizeObserver(() => viewer.set_3d_pane_size());
  observer.observe(element);
  viewer.set_3d_pane_size();
  return () => observer.disconnect();
}
