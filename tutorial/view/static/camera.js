// The camera of a view: how drags, the wheel and keys move it, and its limits. All views of a scene share this file.
// A robot is a body with a frame `base_link`: see tutorial/view/frames.py.

const LOWEST = 0.05;  // height of the camera above the floor [m]
const NARROW = 0.9;  // pictures with a smaller ratio of width to height show the same horizontal range as at this ratio
const NEAREST = 1 / 12, FARTHEST = 4;  // the distances that zooming allows, as multiples of the program's distance

/** The paths of all frames' axes in a scene, each as a list of names. */
function axesIn({scene_tree}) {
  const pathsBelow = (node, path) => Object.entries(node.children).flatMap(([name, child]) => (
    path.at(-1) === "frames" ? [[...path, name]] : pathsBelow(child, [...path, name])));
  return pathsBelow(scene_tree, []);
}

/** Moves the camera of a meshcat viewer. */
class Camera {
  constructor(viewer) {
    this.viewer = viewer;
    this.controls = viewer.controls;
    this.followed = "";  // the path of the robot's base_link
    const update = this.controls.update.bind(this.controls);
    this.controls.update = () => this.update(update);
  }

  get distance() {
    return this.controls.object.position.distanceTo(this.controls.target);
  }

  /** Move the camera and its target. */
  shift(by) {
    this.controls.target.add(by);
    this.controls.object.position.add(by);
  }

  /** Apply the mouse's input, follow the robot, and enforce the limits. meshcat also calls this for each picture. */
  update(apply) {
    const {controls} = this, {target, position0, target0} = controls;
    const home = position0.distanceTo(target0) || 1, before = this.distance;
    Object.assign(controls, {minDistance: NEAREST * home, maxDistance: FARTHEST * home, maxPolarAngle: Math.PI});
    controls.object.zoom = Math.min(1, controls.object.aspect / NARROW);
    const isChanged = apply();
    this.approach(this.distance / before);
    this.keepUp();
    target.y = Math.max(target.y, Math.min(0, target0.y));  // three.js: y is up
    const lowest = (Math.min(LOWEST, position0.y) - target.y) / this.distance;
    controls.maxPolarAngle = Math.acos(Math.max(-1, Math.min(lowest, 1)));
    return apply() || isChanged;
  }

  /** Return the robots' positions by the paths of their frames, in the coordinates of the camera's position. */
  robots() {
    const found = new Map();
    for (const path of axesIn(this.viewer)) {
      if (!path.at(-1).endsWith(".base_link")) continue;
      const {object} = this.viewer.scene_tree.find(path.slice(0, -2));
      const place = object.getWorldPosition(new MeshCat.THREE.Vector3());
      found.set(path.join("/"), this.controls.object.parent.worldToLocal(place));
    }
    return found;
  }

  /** Return the robot nearest to the middle of the picture, as [path, place]. */
  nearest() {
    const away = ([, place]) => place.distanceTo(this.controls.target);
    return [...this.robots()].sort((one, other) => away(one) - away(other))[0];
  }

  /** While zooming in, move the nearest robot towards the middle of the picture, so that it stays visible. */
  approach(scale) {
    const place = scale < 1 && this.nearest()?.[1];
    if (!place || !this.sees(place)) return;
    this.shift(place.sub(this.controls.target).multiplyScalar(Math.min(1, 2 * (1 - scale))));
  }

  sees(place) {
    const camera = this.controls.object, {x, y, z} = camera.parent.localToWorld(place.clone()).project(camera);
    return Math.abs(x) < 1 && Math.abs(y) < 1 && z < 1;
  }

  /** Follow the robot in the middle of the picture, or stop following. */
  follow() {
    const [path, place] = (!this.followed && this.nearest()) || [""];
    this.followed = path;
    this.last = place;
    if (path) this.shift(place.clone().sub(this.controls.target));
    this.viewer.set_dirty();
  }

  keepUp() {
    const place = this.followed && this.robots().get(this.followed);
    if (!place) return;
    this.shift(place.clone().sub(this.last));
    this.last = place;
  }

  /** Move the camera back to where the program placed it. */
  reset() {
    this.followed = "";
    this.controls.reset();
  }

  /** Turn the camera about its target [rad], and multiply its distance. */
  turn(right, down, scale) {
    const {object, target} = this.controls;
    const angles = new MeshCat.THREE.Spherical().setFromVector3(object.position.clone().sub(target));
    angles.theta += right;
    angles.phi = Math.max(0.05, Math.min(angles.phi + down, Math.PI - 0.05));
    angles.radius *= scale;
    object.position.setFromSpherical(angles).add(target);
    this.approach(scale);
    this.viewer.set_dirty();
  }
}
