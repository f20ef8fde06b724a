// Replays runs: the page's side of tutorial/view/replay.py. The files of every view (VIEW in tutorial/view/assets.py)
// precede this file in the same script.

const NEAR = "300px";  // pictures exist only within this distance from the window
const SHORTEST = 0.1;  // duration of a run that gets a slider [s]
const SHOWN_JOINTS = 6;

/** Decode and decompress data. */
async function unpacked(text) {
  const zipped = Uint8Array.from(atob(text.trim()), (character) => character.charCodeAt(0));
  return new Response(new Blob([zipped]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

/** Return the index of the last of these times that is not after `time`. */
function at(times, time) {
  let from = 0, to = times.length;
  while (to - from > 1) {
    const middle = (from + to) >> 1;
    if (times[middle] <= time) from = middle;
    else to = middle;
  }
  return from;
}

/** Format a joint's position; "?" if it is unknown. */
function inFigures(position) {
  return Number.isFinite(position) ? position.toFixed(3).replace("-", "−") : "?";
}

/** One run: its picture, a button, a slider, and the joints' positions. */
class Replay {
  constructor(figure, timeline, scene) {
    Object.assign(this, timeline);
    this.scene = scene;
    this.time = 0;
    this.isPlaying = false;
    this.duration = this.times.at(-1) ?? 0;
    this.sinceWhen = this.lines.map(([since]) => since);
    this.build(figure);
    this.listen();
    this.seek(0);
    figure.replay = this;  // for the curious, in the browser's console
  }

  build(figure) {
    const frame = make("div", "tank-view-frame");
    this.pane = makePane(this.title);
    this.curtain = make("div", "tank-view-curtain", {role: "status", hidden: ""});
    frame.append(this.pane, this.curtain);
    const bar = make("div", "tank-replay-bar");
    this.button = make("button", "", {type: "button"}, "Play");
    this.slider = make("input", "", {
      "type": "range", "min": "0", "max": String(this.duration), "step": "any", "aria-label": "time",
    });
    this.clock = make("output", "tank-replay-clock");
    bar.hidden = this.duration < SHORTEST;
    bar.append(this.button, this.slider, this.clock);
    this.where = make("div", "tank-replay-joints");
    this.line = make("div", "tank-replay-line");
    figure.append(frame, bar, this.where, this.line);
  }

  listen() {
    this.button.addEventListener("click", () => (this.isPlaying ? this.pause() : this.play()));
    this.slider.addEventListener("input", () => {
      this.pause();
      this.seek(Number(this.slider.value));
    });
    new IntersectionObserver((entries) => {
      if (entries.at(-1).isIntersecting) this.open();
      else this.close();
    }, {rootMargin: NEAR}).observe(this.pane);
  }

  /** Make the picture. Browsers allow few WebGL contexts, so runs far from the window have none. */
  open() {
    if (this.picture) return;
    try {
      this.picture = new Picture(this.pane, () => this.say(...TAKEN));
    } catch (error) {
      this.say(...noGraphics(error));
      return;
    }
    new SceneReader(this.picture.viewer, () => {}).read(this.scene);
    const {animator} = this.picture.viewer;
    animator.play();  // the animator can seek only after it has played
    animator.pause();
    this.curtain.hidden = true;
    this.seek(this.time);
  }

  close() {
    this.pause();
    this.picture?.dispose();
    this.picture = null;
  }

  say(title, hint) {
    this.curtain.replaceChildren(make("strong", "", {}, title), make("span", "", {}, hint));
    this.curtain.hidden = false;
  }

  play() {
    if (this.isPlaying) return;
    this.isPlaying = true;
    this.button.textContent = "Pause";
    if (this.time >= this.duration) this.seek(0);
    let before = performance.now();
    const step = (now) => {
      if (!this.isPlaying) return;
      this.seek(Math.min(this.time + (now - before) / 1000, this.duration));
      before = now;
      if (this.time < this.duration) this.request = requestAnimationFrame(step);
      else this.pause();
    };
    this.request = requestAnimationFrame(step);
  }

  pause() {
    cancelAnimationFrame(this.request);
    this.isPlaying = false;
    this.button.textContent = "Play";
  }

  /** Show this time [s] of the run. */
  seek(time) {
    this.time = time;
    this.picture?.viewer.animator.seek(time);
    this.slider.value = String(time);
    this.clock.textContent = `${time.toFixed(1)} of ${this.duration.toFixed(1)} s`;
    this.slider.setAttribute("aria-valuetext", this.clock.textContent);
    this.where.textContent = this.inWords();
    const line = this.lines[at(this.sinceWhen, time)];
    sayBelow(this.line, line && line[0] <= time ? line[1] : "");
  }

  /** Return a joint's position [rad], or [m], interpolated between two frames as in the picture; NaN if unknown. */
  position(name) {
    const {times, time} = this, i = at(times, time), j = Math.min(i + 1, times.length - 1);
    const values = this.joints[name].map((value) => value ?? NaN);
    const share = times[j] > times[i] ? (time - times[i]) / (times[j] - times[i]) : 0;
    return values[i] + share * (values[j] - values[i]);
  }

  inWords() {
    const names = Object.keys(this.joints), bodies = new Set(names.map((name) => name.split(" ")[0]));
    const label = (name) => (bodies.size > 1 ? name : name.slice(name.indexOf(" ") + 1));
    const say = (name) => `${label(name)} ${inFigures(this.position(name))}`;
    return names.slice(0, SHOWN_JOINTS).map(say).join(" · ");
  }
}

async function startReplays() {
  const viewer = document.getElementById("tank-viewer");
  if (viewer) takeLibrary(Uint8Array.from(atob(viewer.textContent.trim()), (character) => character.charCodeAt(0)));
  else library().resolve();  // the page has loaded it with its own script
  for (const figure of document.querySelectorAll(".tank-replay")) {
    try {
      const [timeline, scene] = await Promise.all(
        [".timeline", ".scene"].map((part) => unpacked(figure.querySelector(part).textContent)));
      await library().ready;
      new Replay(figure, JSON.parse(new TextDecoder().decode(timeline)), scene);
    } catch (error) {
      console.error("a run cannot be replayed:", error);
      figure.append(`This run cannot be shown here: ${error.message}`);
    }
  }
}

startReplays();
