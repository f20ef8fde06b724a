// The page `drive`: two programs of the course in the visitor's browser, with the visitor's own controllers.
// make.js, scene.js, viewer.js and the joystick stand before this text in the same script.

const FILES = new URL("drive/", document.currentScript.src);
const LOOK_EVERY = 500;  // whether the programs answer [ms]
const STUCK = 6;  // looks without an answer, after which a program is ended
const STUCK_TEXT = "The controller has not returned for three seconds, so its program was ended. Is there a loop that never ends? " +
  "Mend it, and press Run.";

const SEEN = 5;  // digits of a pose that make a difference to the eye

const file = (name) => new URL(name, FILES);

async function read(name, kind) {
  const answer = await fetch(file(name));
  if (!answer.ok) throw new Error(`${name} is not there: ${answer.status}`);
  return answer[kind]();
}

/** meshcat's viewer is a script. */
function loadViewer() {
  return new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.onload = resolve;
    script.onerror = () => reject(new Error("meshcat's viewer was not loaded"));
    script.src = new URL("main.min.js", document.querySelector("#drive").dataset.static);
    document.head.append(script);
  });
}

/** A picture of one program's world. */
class WorldView {
  constructor(title, scene, paths) {
    this.paths = Object.entries(paths).map(([body, path]) => [Number(body), path.split("/").filter(Boolean)]);
    this.node = make("div", "tank-view drive-view");
    this.pane = makePane(title);
    this.line = make("div", "tank-view-line", {role: "status"});
    this.node.append(this.pane, this.line);
    this.scene = scene;
    this.shown = new Map();
  }

  /** Once it is on the page. */
  open() {
    try {
      this.picture = new Picture(this.pane, () => { this.line.textContent = TAKEN.join(" "); });
    } catch (error) {
      this.line.textContent = noGraphics(error).join(" ");
      return;
    }
    listenToKeys(this.pane, () => this.picture);
    new SceneReader(this.picture.viewer, () => {}).read(this.scene);
  }

  /** xpos, xmat: of all MuJoCo bodies, as MuJoCo has them. */
  show(xpos, xmat) {
    if (!this.picture) return;
    const {viewer} = this.picture;
    for (const [body, path] of this.paths) {
      const [a, b, c, d, e, f, g, h, i] = xmat.subarray(9 * body, 9 * body + 9);
      const [x, y, z] = xpos.subarray(3 * body, 3 * body + 3);
      const matrix = [a, d, g, 0, b, e, h, 0, c, f, i, 0, x, y, z, 1];
      const rounded = matrix.map((value) => value.toFixed(SEEN)).join();
      if (this.shown.get(body) === rounded) continue;  // a page that stands still costs no battery
      this.shown.set(body, rounded);
      viewer.set_transform(path, matrix);
      viewer.set_dirty();
    }
  }
}

/** A program in a worker, its world's view, and the controller in it that the visitor edits. */
class Program {
  constructor(setup, scene, wireName, on) {
    Object.assign(this, {setup, wireName, on});
    this.source = setup.source;
    this.view = new WorldView(setup.title, scene, setup.paths);
    this.status = "";
    this.isReady = false;
  }

  /** Start the worker; resolves when it is ready. */
  start(onLoaded = () => {}) {
    this.unanswered = 0;
    this.isReady = false;
    this.worker = new Worker(file("worker.js"), {type: "module"});
    const ready = new Promise((resolve, reject) => {
      const fail = (text) => {
        this.end(text);
        reject(new Error(text));
      };
      this.worker.onerror = (event) => fail(event.message || "the worker does not start");
      this.worker.onmessage = ({data}) => {
        this.unanswered = 0;
        if (data.type === "loaded") onLoaded(data.what);
        else if (data.type === "broken") fail(data.text);
        else if (data.type === "ready") resolve();
        else this.take(data);
      };
    });
    this.tell("start", {setup: {...this.setup, source: this.source}, wireName: this.wireName});
    return ready.then(() => { this.isReady = true; });
  }

  tell(type, more = {}) {
    this.worker.postMessage({type, ...more});
  }

  take(data) {
    if (data.type === "state") {
      this.state = data;
      this.view.show(data.xpos, data.xmat);
    } else if (data.type === "result") {
      this.status = data.error;
    } else if (data.type === "line") {
      this.line = data.text;
    }
    this.on(this, data);
  }

  run(source) {
    this.source = source;
    if (this.worker) this.tell("run", {source});
    else this.start().catch(() => {});  // `end` has said it
  }

  /** End the worker, and say why. */
  end(error) {
    this.worker?.terminate();
    this.worker = null;
    this.take({type: "result", after: "end", error});
  }

  /** End it if it does not answer. */
  look() {
    if (!this.worker || !this.isReady) return;
    if (this.unanswered >= STUCK) {
      this.end(STUCK_TEXT);
      return;
    }
    this.unanswered += 1;
    this.tell("ping");
  }
}

/** The editor: a text with the numbers of its lines, and the errors. */
class Editor {
  constructor(onRun) {
    this.node = make("div", "drive-editor");
    this.tabs = make("div", "drive-tabs", {role: "tablist"});
    this.numbers = make("pre", "drive-numbers", {"aria-hidden": "true"});
    this.text = make("textarea", "drive-text", {
      "spellcheck": "false", "autocomplete": "off", "autocapitalize": "off", "wrap": "off", "aria-label": "the controller's Python",
    });
    const box = make("div", "drive-box");
    box.append(this.numbers, this.text);
    this.error = make("div", "drive-error", {role: "alert"});
    this.node.append(this.tabs, box, this.error);
    this.text.addEventListener("input", () => this.number());
    this.text.addEventListener("scroll", () => { this.numbers.scrollTop = this.text.scrollTop; });
    this.text.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && (event.ctrlKey || event.metaKey || event.shiftKey)) {
        event.preventDefault();
        onRun();
      }
    });
  }

  set(source) {
    this.text.value = source;
    this.text.scrollTop = this.text.scrollLeft = 0;
    this.number();
  }

  number(wrong = 0) {
    const count = this.text.value.split("\n").length;
    const lines = Array.from({length: count}, (_, i) => make("span", i + 1 === wrong ? "drive-wrong" : "", {}, `${i + 1}\n`));
    this.numbers.replaceChildren(...lines);
    this.numbers.scrollTop = this.text.scrollTop;
  }

  /** Say what is wrong, and show the line. */
  say(text) {
    this.error.textContent = text;
    this.error.hidden = !text;
    const line = Number(/, line (\d+)/.exec(text)?.[1] ?? 0);
    const height = this.text.scrollHeight / this.text.value.split("\n").length;
    if (line && Math.abs(this.text.scrollTop / height + 8 - line) > 6) this.text.scrollTop = Math.max(0, line - 8) * height;
    this.number(line);
  }
}

/** Which topics there are, and how many messages a second, as they are heard on the page's wire. */
class Topics {
  constructor(wireName) {
    this.node = make("table", "drive-topics");
    this.counts = new Map();
    this.channel = new BroadcastChannel(wireName);
    this.channel.onmessage = ({data: {topic, type, data}}) => {
      if (!topic) return;
      const heard = this.counts.get(topic) ?? {type, count: 0};
      this.counts.set(topic, {type, count: heard.count + 1, size: data.byteLength});
    };
    this.since = performance.now();
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
    this.root = root;
    root.dataset.static = new URL("./", document.currentScript.src);
    this.button = root.querySelector("button");
    this.progress = root.querySelector(".drive-progress");
    this.button.addEventListener("click", () => this.start().catch((error) => {
      console.error(error);
      this.progress.textContent = `This does not work here: ${error.message}`;
      this.button.disabled = false;
    }));
    root.drive = this;  // for the curious, in the browser's console
  }

  async start() {
    this.button.disabled = true;
    const loaded = [];
    const say = (what) => {
      loaded.push(what);
      this.progress.textContent = `Loading… ${loaded.join(", ")}: there.`;
    };
    this.progress.textContent = "Loading…";
    const wireName = crypto.randomUUID?.() ?? `${Date.now()} ${Math.random()}`;  // a wire for each page that is open
    const [setups, scenes] = await Promise.all([
      read("world.json", "json"),
      Promise.all(["simulation", "viewer"].map((name) => read(`${name}.scene`, "arrayBuffer"))),
      loadViewer().then(() => say("the 3D view")),
    ]);
    const on = (program, data) => this.take(program, data);
    this.programs = ["simulation", "viewer"].map((name, i) => new Program(setups[name], scenes[i], wireName, on));
    [this.simulation, this.viewer] = this.programs;
    this.topics = new Topics(wireName);
    await this.simulation.start(say);
    this.build();
    this.isReady = true;
    const {line} = this.viewer.view;
    line.textContent = "Loading…";
    this.viewer.start().catch((error) => { line.textContent = `It does not start: ${error.message}`; });
    setInterval(() => {
      if (!document.hidden) this.programs.forEach((program) => program.look());
    }, LOOK_EVERY);
    setInterval(() => this.figures(), 1000);
  }

  build() {
    const left = make("div", "drive-left"), right = make("div", "drive-right");
    this.sticks = make("div", "drive-sticks");
    this.editor = new Editor(() => this.run());
    const bar = make("div", "drive-bar");
    this.buttons = {Run: () => this.run(), Reset: () => this.reset(), "Original": () => this.restore()};
    for (const [name, act] of Object.entries(this.buttons)) {
      const button = make("button", `drive-button drive-${name.toLowerCase()}`, {type: "button"}, name);
      button.addEventListener("click", act);
      bar.append(button);
    }
    this.tabs = this.programs.map((program) => {
      const tab = make("button", "drive-tab", {type: "button", role: "tab"}, program.setup.file);
      tab.addEventListener("click", () => this.edit(program));
      return tab;
    });
    this.editor.tabs.append(...this.tabs);
    this.editor.node.append(bar);
    const caption = (text) => make("div", "drive-caption", {}, text);
    left.append(caption(this.simulation.setup.title), this.simulation.view.node, this.sticks);
    const {viewer} = this;
    right.append(this.editor.node, caption(viewer.setup.title), viewer.view.node, caption("On the wire between them"), this.topics.node);
    this.root.replaceChildren(left, right);
    this.root.classList.add("drive-on");
    this.programs.forEach((program) => program.view.open());
    const send = ({axes, buttons}) => this.simulation.worker?.postMessage({type: "sticks", axes, buttons});
    joystick.render({el: this.sticks, model: {get: () => false, on() {}, off() {}, send}});
    this.edit(this.simulation);
    this.focusSticks();
  }

  edit(program) {
    if (this.edited) this.edited.source = this.editor.text.value;
    this.edited = program;
    this.tabs.forEach((tab, i) => tab.setAttribute("aria-selected", String(this.programs[i] === program)));
    this.editor.set(program.source);
    this.editor.say(program.status);
  }

  run() {
    this.editor.say("");
    this.edited.run(this.editor.text.value);
    if (document.activeElement !== this.editor.text) this.focusSticks();
  }

  /** Have the keys drive. */
  focusSticks() {
    this.sticks.firstElementChild.focus({preventScroll: true});
  }

  reset() {
    this.editor.say("");
    if (this.simulation.worker) this.simulation.tell("reset");
    else if (this.simulation === this.edited) this.run();
    else this.simulation.run(this.simulation.source);
  }

  restore() {
    this.editor.set(this.edited.setup.source);
    this.run();
  }

  take(program, data) {
    if (data.type === "result" && program === this.edited && (data.error || data.after !== "turn")) this.editor.say(data.error);
    if (data.type === "line") program.view.line.textContent = `${data.text}.`;
    if (data.type === "log") console.debug(data.text);
  }

  /** Once a second: where the joints are, how fast it goes, and what is on the wire. */
  figures() {
    this.topics.show();
    const {state, view} = this.simulation, now = performance.now();
    if (!state) return;
    const factor = this.last ? (state.step - this.last.step) / (now - this.last.now) : 0;
    this.last = {step: state.step, now};
    const inFigures = ([name, position, effort]) => `${name} ${position.toFixed(3)} rad, ${effort.toFixed(2)} N·m`;
    view.line.textContent = [...state.joints.map(inFigures), `${Math.max(0, factor).toFixed(2)} of real time`].join(" · ").replaceAll("-", "−");
  }
}

const root = document.getElementById("drive");
if (root) new Drive(root);
