// The page `drive`: two programs of the course in the visitor's browser, with the visitor's own controllers.
// The files of every view (VIEW in tutorial/view/assets.py) and the joystick precede this file in the same script.

const HERE = document.currentScript.src, MESHCAT = new URL("main.min.js", HERE);
const LOOK_EVERY = 500;  // [ms] between checks of whether the programs are working
const STUCK = 6;  // checks without a sign of work, after which a program is ended
const STUCK_TEXT = "The controller has not returned for three seconds, so its program was ended. Is there a loop that never ends? " +
  "Fix it, and press Run.";

const SEEN = 5;  // visible digits of a pose

const file = (name) => new URL(`drive/${name}`, HERE);

const read = (name, kind) => fetch(file(name)).then((answer) => {
  if (!answer.ok) throw new Error(`${name} could not be loaded: ${answer.status}`);
  return answer[kind]();
});

/** A picture of one program's world. */
class WorldView {
  constructor(node, scene, paths) {
    this.paths = Object.entries(paths).map(([body, path]) => [Number(body), path.split("/").filter(Boolean)]);
    this.line = node.querySelector(".tank-view-line");
    this.shown = new Map();
    const pane = makePane(node.previousElementSibling.textContent);
    const frame = make("div", "tank-view-frame");
    frame.append(pane);
    node.prepend(frame);
    try {
      this.picture = new Picture(pane, () => this.say(TAKEN.join(" ")));
    } catch (error) {
      this.blind = noGraphics(error).join(" ");
      return this.say();
    }
    new SceneReader(this.picture.viewer, () => {}).read(scene);
  }

  /** Write the line below the picture, unless it explains why there is no picture. */
  say(text) {
    this.line.textContent = this.blind ?? text;
  }

  /** Move all bodies. xpos, xmat: MuJoCo's arrays. */
  show({xpos, xmat}) {
    if (!this.picture) return;
    const {viewer} = this.picture;
    for (const [body, path] of this.paths) {
      const [a, b, c, d, e, f, g, h, i] = xmat.subarray(9 * body, 9 * body + 9);
      const [x, y, z] = xpos.subarray(3 * body, 3 * body + 3);
      const matrix = [a, d, g, 0, b, e, h, 0, c, f, i, 0, x, y, z, 1];
      const rounded = matrix.map((value) => value.toFixed(SEEN)).join();
      if (this.shown.get(body) === rounded) continue;  // a still scene should cost no battery
      this.shown.set(body, rounded);
      viewer.set_transform(path, matrix);
      viewer.set_dirty();
    }
  }
}

/** A program in a worker, its world's view, and the controller in it that the visitor edits. */
class Program {
  constructor(setup, wireName, onError) {
    Object.assign(this, {setup, wireName, onError, source: setup.source, error: ""});
  }

  /** Start the worker; resolves when it is ready. */
  start(onLoaded = () => {}) {
    this.silentFor = -Infinity;  // no limit until it is ready
    this.worker = new Worker(file("worker.js"), {type: "module"});
    this.tell("start", {setup: {...this.setup, source: this.source}, wireName: this.wireName});
    return new Promise((resolve, reject) => {
      const broken = (text) => reject(this.end(text));
      const ready = () => resolve(this.silentFor = 0);
      const state = (state) => {
        Object.assign(this, {state, silentFor: 0});
        this.view?.show(state);
      };
      const error = (text) => this.say(text), line = (text) => this.view?.say(`${text}.`), log = console.debug;
      const hear = {loaded: onLoaded, broken, ready, state, error, line, log};
      this.worker.onerror = ({message}) => broken(message || "the worker does not start");
      this.worker.onmessage = ({data: [what, value]}) => hear[what](value);
    });
  }

  tell(type, more = {}) {
    this.worker?.postMessage({type, ...more});
  }

  /** Run the visitor's controller. */
  run() {
    if (this.worker) this.tell("run", {source: this.source});
    else this.start().catch(() => {});  // `end` has reported it
  }

  say(error) {
    this.error = error;
    this.onError(this);
  }

  /** End the worker, show the reason, and return it as an error. */
  end(text) {
    this.worker?.terminate();
    this.worker = null;
    this.say(text);
    return new Error(text);
  }

  /** End the program if it has shown no sign of work for too long. */
  look() {
    if (this.worker && ++this.silentFor > STUCK) this.end(STUCK_TEXT);
  }
}

const WORDS = "and as assert async await break class continue def del elif else except finally for from global if import in is lambda " +
  "nonlocal not or pass raise return try while with yield None True False";
const PYTHON = new RegExp([
  String.raw`(?<comment>#.*)`,
  String.raw`(?<string>(?<!\w)[rbfuRBFU]{0,2}(?:"""[^]*?(?:"""|$)|'''[^]*?(?:'''|$)|"(?:\\.|[^"\\\n])*"?|'(?:\\.|[^'\\\n])*'?))`,
  String.raw`\b(?<keyword>${WORDS.replaceAll(" ", "|")})\b`,
  String.raw`(?<=\b(?:def|class)\s+)(?<name>\w+)`,
  String.raw`\b(?<number>\d[\w.]*)`,
].join("|"), "g");

/** Colour Python. Returns the lines, each as a list of elements and texts. */
function coloured(source) {
  const lines = [[]];
  const add = (text, kind) => text.split("\n").forEach((part, i) => {
    if (i) lines.push([]);
    lines.at(-1).push(kind ? make("span", `drive-${kind}`, {}, part) : part);
  });
  let end = 0;
  for (const {0: text, index, groups} of source.matchAll(PYTHON)) {
    add(source.slice(end, index));
    add(text, Object.keys(groups).find((kind) => groups[kind] !== undefined));
    end = index + text.length;
  }
  add(source.slice(end));
  return lines;
}

/**
 * The editor, and the errors. The text field is transparent; the visible copy behind it has colours and line numbers.
 * Both break long lines in the same places.
 */
class Editor {
  constructor(root, onInput) {
    [this.box, this.copy, this.text, this.error] = ["box", "copy", "text", "error"].map((name) => root.querySelector(`.drive-${name}`));
    this.text.addEventListener("input", () => {
      this.show();
      onInput(this.text.value);
    });
  }

  set(source) {
    this.text.value = source;
    this.box.scrollTop = 0;
    this.show();
  }

  show(wrong = 0) {
    const lines = coloured(this.text.value).map((parts, i) => {
      const line = make("div", i + 1 === wrong ? "drive-line drive-wrong" : "drive-line");
      line.append(...parts, "\n");
      return line;
    });
    this.copy.replaceChildren(...lines);
  }

  /** Show an error, and scroll to its line. */
  say(text) {
    Object.assign(this.error, {textContent: text, hidden: !text});
    const number = Number(/, line (\d+)/.exec(text)?.[1] ?? 0);
    this.show(number);
    const line = this.copy.children[number - 1], {scrollTop, clientHeight} = this.box;
    if (line && (line.offsetTop < scrollTop || line.offsetTop + line.offsetHeight > scrollTop + clientHeight)) {
      this.box.scrollTop = line.offsetTop - clientHeight / 3;
    }
  }
}

/** The topics on the page's wire, with their message rates. */
class Topics {
  constructor(node, wireName) {
    Object.assign(this, {node, counts: new Map(), since: performance.now(), channel: new BroadcastChannel(wireName)});
    this.channel.onmessage = ({data: {topic, type, data}}) => {
      if (topic) this.counts.set(topic, {type, count: 1 + (this.counts.get(topic)?.count ?? 0), size: data.byteLength});
    };
  }

  show() {
    const now = performance.now(), seconds = (now - this.since) / 1000;
    this.since = now;
    const rows = [...this.counts].sort().map(([topic, heard]) => {
      const row = make("tr", "");
      const name = topic.replace(/^rt/, ""), kind = heard.type.replace("::dds_::", "/").replace("::", "/").replace(/_$/, "");
      const size = `${Math.round(heard.count / seconds)} messages of ${heard.size} bytes in a second`;
      row.append(...[name, kind, size].map((text) => make("td", "", {}, text)));
      heard.count = 0;
      return row;
    });
    this.node.replaceChildren(...rows);
  }
}

class Drive {
  constructor(root) {
    Object.assign(this, {root, button: root.querySelector("button"), progress: root.querySelector(".drive-progress")});
    this.button.addEventListener("click", () => this.start().catch((error) => {
      console.error(error);
      this.progress.textContent = `The page could not start: ${error.message}. Reload it to try again.`;
      this.simulation?.end("");
    }));
    root.drive = this;  // for the curious, in the browser's console
  }

  async start() {
    this.button.disabled = true;
    const loaded = [], say = (what) => {
      loaded.push(what);
      this.progress.textContent = `Loading… ${loaded.join(", ")}: done.`;
    };
    this.progress.textContent = "Loading…";
    const wireName = `${Date.now()} ${Math.random()}`;  // a separate wire for each open page
    const names = ["simulation", "viewer"], setups = await read("world.json", "json");
    const onError = (program) => { if (program === this.edited) this.editor.say(program.error); };
    this.programs = names.map((name) => new Program(setups[name], wireName, onError));
    [this.simulation, this.viewer] = this.programs;
    const [scenes] = await Promise.all([
      Promise.all(names.map((name) => read(`${name}.scene`, "arrayBuffer"))),
      import(MESHCAT).then(() => say("the 3D view")),
      this.simulation.start(say),
    ]);
    this.build(scenes);
    this.topics = new Topics(this.root.querySelector(".drive-topics"), wireName);
    this.isReady = true;
    this.viewer.view.say("Loading…");
    this.viewer.start().catch(({message}) => this.viewer.view.say(`The viewer could not start: ${message}`));
    setInterval(() => document.hidden || this.programs.forEach((program) => program.look()), LOOK_EVERY);
    setInterval(() => this.figures(), 1000);
  }

  /** Replace the button with the page's parts. */
  build(scenes) {
    const {root, programs} = this;
    root.replaceChildren(document.getElementById("drive-parts").content);
    root.classList.add("drive-on");
    const views = root.querySelectorAll(".drive-view");
    programs.forEach((program, i) => { program.view = new WorldView(views[i], scenes[i], program.setup.paths); });
    this.editor = new Editor(root, (source) => { this.edited.source = source; });
    this.tabs = [...root.querySelectorAll(".drive-tab")];
    this.tabs.forEach((tab, i) => tab.addEventListener("click", () => this.edit(programs[i])));
    for (const act of ["run", "reset", "restore"]) root.querySelector(`.drive-${act}`).addEventListener("click", () => this[act]());
    this.sticks = root.querySelector(".drive-sticks");
    const send = ({axes, buttons}) => this.simulation.tell("sticks", {axes, buttons});
    joystick.render({el: this.sticks, model: {get: () => false, on() {}, off() {}, send}});
    this.edit(this.simulation);
    this.focusSticks();
  }

  edit(program) {
    this.edited = program;
    this.tabs.forEach((tab, i) => tab.setAttribute("aria-selected", String(this.programs[i] === program)));
    this.editor.set(program.source);
    this.editor.say(program.error);
  }

  run() {
    this.editor.say("");
    this.edited.run();
    if (document.activeElement !== this.editor.text) this.focusSticks();
  }

  /** Drive with the keys. */
  focusSticks() {
    this.sticks.firstElementChild.focus({preventScroll: true});
  }

  reset() {
    this.editor.say("");
    this.simulation.worker ? this.simulation.tell("reset") : this.simulation.run();
  }

  restore() {
    this.editor.set(this.edited.source = this.edited.setup.source);
    this.run();
  }

  /** Once a second: where the joints are, how fast it goes, and what is on the wire. */
  figures() {
    this.topics.show();
    const {state, view} = this.simulation, now = performance.now();
    if (!state) return;
    const factor = this.last ? (state.step - this.last.step) / (now - this.last.now) : 0;
    this.last = {step: state.step, now};
    const inFigures = ([name, position, effort]) => `${name} ${position.toFixed(3)} rad, ${effort.toFixed(2)} N·m`;
    view.say([...state.joints.map(inFigures), `${Math.max(0, factor).toFixed(2)} of real time`].join(" · ").replaceAll("-", "−"));
  }
}

new Drive(document.getElementById("drive"));
