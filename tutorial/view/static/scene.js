// Feeds the messages of tutorial/view/scene.py to a meshcat viewer, in a page or in a notebook cell.

const COMMAND = 0, LINE = 1, CLEAR = 2, CAMERA = 3;  // as in Record in tutorial/view/scene.py
const ONLY_ONCE = new Set(["Background", "Cameras"]);  // the built-in objects that a viewer cannot create again

const BY_PROCESSOR = /swiftshader|llvmpipe|softpipe|software|basic render/i;  // renderers that need no graphics card
const PAUSE = 100;  // between pictures without a graphics card [ms]

/** The title and hint to show if a viewer cannot be made. */
export const noGraphics = ({message}) =>
  ["This browser cannot show 3D graphics.", `It has no WebGL, or WebGL is switched off. The error was: ${message}`];

/** Return whether a graphics card draws a canvas. If the browser does not reveal it, assume that it does. */
function hasCard(gl) {
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  return !names || !BY_PROCESSOR.test(gl.getParameter(names.UNMASKED_RENDERER_WEBGL));
}

/**
 * Make a meshcat viewer in an element, which draws when something has changed. Without a graphics card, it saves two
 * thirds of the CPU time for the simulation and the page: no shadows, no antialiasing, ten pictures a second.
 * isSeen: returns whether the viewer is visible. Returns the viewer, and a function that disposes of it.
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

/** Release a WebGL context: a browser has only 16. */
function release(renderer) {
  renderer.dispose();
  renderer.forceContextLoss();
}

/** Show the text of a LINE record below a view: a line, and a table's rows, with tabs between the cells. */
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

/** Yield the records of a message, as {kind, payload}. */
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
 * Make it possible to replace a light any number of times. meshcat removes a light's controls from the page, but not
 * from its list: at the third light it would remove them again, which fails. It also leaks the light's shadow map.
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

/** Dispose of lights, which meshcat forgets when it disposes of a part of the scene. */
function letGo({object}) {
  object.traverse((each) => {
    if (each.isLight) each.dispose();
    for (const part of [each.geometry, each.material?.map, each.material]) part?.dispose?.();
  });
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
      } catch (error) {  // show the other records anyway
        console.error("a record of kind", kind, "cannot be shown:", error);
      }
    }
  }

  /** Restore the initial state, except for the camera, which the user may have turned. */
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

  // A view that the user has turned stays that way when the same scene is shown again.
  place(payload, isWhole) {
    if (isWhole && this.camera === payload.join()) return;
    this.camera = payload.join();
    const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
    const [x, y, z, toX, toY, toZ] = [0, 8, 16, 24, 32, 40].map((start) => view.getFloat64(start, true));
    const {viewer} = this;
    viewer.set_transform(["Cameras", "default"], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    viewer.camera.position.set(x, z, -y);  // three.js: y is up
    viewer.controls.target.set(toX, toZ, -toY);
    viewer.controls.saveState();  // the state that a reset restores
    viewer.set_dirty();
  }
}

/** Keep the picture as large as its element; meshcat would use the window's height. Returns a function to stop it. */
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
