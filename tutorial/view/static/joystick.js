// Two sticks in a notebook's cell: the page's side of tutorial/notebook/widgets/joystick.py. Left and up are +1, as in
// ROS 2. make.js and cell.js precede this file in the same module.

const REPEAT = 100;  // interval of messages while a stick is held [ms]; the kernel releases the sticks after 500
const CALM = 600;  // how long the sticks have to stay unchanged before they are read aloud [ms]
const REACH = 0.28, KNOB = 0.44;  // range and size of a knob, relative to the pad's width
const NOTHING = {axes: Array(6).fill(0), buttons: Array(15).fill(0)};
const STICKS = [
  {name: "left stick", keys: "W A S D", does: "drives", left: "KeyA", right: "KeyD", up: "KeyW", down: "KeyS"},
  {name: "right stick", keys: "← ↑ ↓ →", does: "aims",
    left: "ArrowLeft", right: "ArrowRight", up: "ArrowUp", down: "ArrowDown"},
];
const KEYS = new Set(STICKS.flatMap(({left, right, up, down}) => [left, right, up, down]));
// The buttons of the Gamepad API's standard mapping in SDL's order: A B X Y, back guide start, sticks, shoulders, pad.
const BUTTONS = [0, 1, 2, 3, 8, 16, 9, 10, 11, 4, 5, 12, 13, 14, 15];
const TRIGGERS = [6, 7];
const ENDED = "The kernel has ended or was restarted. Run the notebook's cells again to get a joystick.";
const CLOSED = "Closed. Run the cell again to get a joystick.";
const OFFLINE = "The connection to Jupyter is lost. The joystick works again when the connection is back.";
const UNKNOWN = "The browser does not know this gamepad's layout, so it is not used: ";
const NO_GAMEPAD = "Drag a stick, click here and press keys, or connect a gamepad and press one of its buttons.";

const clamp = (value) => Math.max(-1, Math.min(value, 1)) || 0;

/** Read a gamepad with the standard mapping. As in ROS 2's joy package, left and up are positive, triggers negative. */
export function readGamepad({axes, buttons}) {
  return {
    axes: [...axes.slice(0, 4).map((axis) => clamp(-axis)), ...TRIGGERS.map((i) => clamp(-buttons[i]?.value))],
    buttons: BUTTONS.map((i) => (buttons[i]?.pressed ? 1 : 0)),
  };
}

/** Combine several inputs of one axis: use the strongest. */
function strongest(...values) {
  return values.reduce((best, value) => (Math.abs(value) > Math.abs(best) ? value : best), 0);
}

/** One stick: a pad with a knob that can be dragged and springs back. */
class Pad {
  constructor({name, keys, does}, onChange, takeFocus) {
    this.value = [0, 0];  // left, up
    this.onChange = onChange;
    this.node = make("div", "tank-stick");
    this.pad = make("div", "tank-stick-pad", {"aria-hidden": "true", "title": `Drag: the ${name}`});
    this.knob = make("div", "tank-stick-knob");
    this.pad.append(this.knob);
    this.numbers = make("div", "tank-stick-numbers", {"aria-hidden": "true"});
    const label = make("div", "tank-stick-label");
    label.append(make("strong", "", {}, name), ` ${does}`, make("br", ""), make("kbd", "", {}, keys));
    this.node.append(this.pad, this.numbers, label);
    this.pointer = null;
    this.pad.addEventListener("pointerdown", (event) => {
      if (this.pointer !== null || event.button !== 0) return;
      event.preventDefault();
      takeFocus();
      this.pointer = event.pointerId;
      this.pad.setPointerCapture(event.pointerId);
      this.drag(event);
    });
    this.pad.addEventListener("pointermove", (event) => {
      if (event.pointerId === this.pointer) this.drag(event);
    });
    for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) {
      this.pad.addEventListener(kind, (event) => {
        if (event.pointerId === this.pointer) this.release();
      });
    }
  }

  drag({clientX, clientY}) {
    const {left, top, width, height} = this.pad.getBoundingClientRect();
    const reach = REACH * width;
    const x = (left + width / 2 - clientX) / reach, y = (top + height / 2 - clientY) / reach;
    const length = Math.max(1, Math.hypot(x, y));
    this.value = [x / length, y / length];
    this.onChange();
  }

  release() {
    this.pointer = null;
    this.value = [0, 0];
    this.onChange();
  }

  show(left, up) {
    const far = 100 * REACH / KNOB;
    this.knob.style.transform = `translate(${-far * left}%, ${-far * up}%)`;
    this.knob.classList.toggle("tank-stick-held", left !== 0 || up !== 0);
    const say = (value) => (value < 0 ? "−" : "+") + Math.abs(value).toFixed(2);
    this.numbers.textContent = `left\u00a0${say(left)}   up\u00a0${say(up)}`;
  }
}

/** Describe the sticks for screen readers. */
function inWords(axes) {
  const one = (name, left, up) => {
    const parts = [[left, "left", "right"], [up, "up", "down"]]
      .filter(([value]) => Math.abs(value) >= 0.05)
      .map(([value, plus, minus]) => `${Math.round(100 * Math.abs(value))} percent ${value > 0 ? plus : minus}`);
    return parts.length ? [`${name} ${parts.join(", ")}`] : [];
  };
  return [...one("left stick", axes[0], axes[1]), ...one("right stick", axes[2], axes[3])].join("; ") || "sticks released";
}

class CellView {
  constructor(model, el) {
    this.model = model;
    this.down = new Set();  // the pressed keys
    this.sent = JSON.stringify(NOTHING);
    this.sentAt = -Infinity;
    this.changedAt = 0;
    this.build(el);
    this.listen();
    this.trouble = "";
    this.onEnded = () => { if (model.get("ended")) this.end(CLOSED); };
    model.on("change:ended", this.onEnded);
    this.onEnded();
    this.unwatch = watchKernel(model, () => this.end(ENDED), (isThere) => { this.trouble = !isThere ? OFFLINE : model.get("ended") ? CLOSED : ""; });
    this.tick = this.tick.bind(this);
    this.request = 0;
  }

  build(el) {
    this.box = make("div", "tank-joystick", {
      "role": "application", "tabindex": "0", "data-lm-suppress-shortcuts": "true", "aria-label": "Joystick",
      "aria-description": "W A S D move the left stick, the arrow keys the right one. Escape leaves it.",
    });
    const focus = () => this.box.focus({preventScroll: true});
    this.pads = STICKS.map((stick) => new Pad(stick, () => this.update(), focus));
    const row = make("div", "tank-joystick-row");
    row.append(...this.pads.map((pad) => pad.node));
    this.status = make("div", "tank-joystick-status");
    this.aloud = make("div", "tank-joystick-aloud", {"aria-live": "polite"});
    this.box.append(row, this.status, this.aloud);
    el.append(this.box);
  }

  listen() {
    const {box} = this;
    box.addEventListener("keydown", (event) => this.onKey(event, true));
    box.addEventListener("keyup", (event) => this.onKey(event, false));
    box.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      box.focus({preventScroll: true});
    });
    this.letGo = () => {
      this.down.clear();
      this.pads.forEach((pad) => pad.release());
    };
    this.onHidden = () => {
      if (document.hidden) this.letGo();
    };
    box.addEventListener("focusout", this.letGo);
    window.addEventListener("blur", this.letGo);
    window.addEventListener("pagehide", this.letGo);
    document.addEventListener("visibilitychange", this.onHidden);
    this.timer = setInterval(() => {
      this.update();
      if (!this.request) this.tick();
    }, REPEAT);
  }

  onKey(event, isDown) {
    if (isDown && (event.ctrlKey || event.altKey || event.metaKey)) return;
    if (isDown && event.key === "Escape") this.box.blur();
    else if (!KEYS.has(event.code)) return;
    else if (isDown) this.down.add(event.code);
    else this.down.delete(event.code);
    event.preventDefault();
    event.stopPropagation();
    this.update();
  }

  /** Combine pads, keys and gamepad. */
  read() {
    const gamepad = document.hidden ? null : this.gamepad();
    const {axes, buttons} = gamepad ? readGamepad(gamepad) : NOTHING;
    const held = STICKS.flatMap(({left, right, up, down}, i) => {
      const [byPadLeft, byPadUp] = this.pads[i].value;
      const key = (plus, minus) => this.down.has(plus) - this.down.has(minus);
      return [strongest(byPadLeft, key(left, right), axes[2 * i]), strongest(byPadUp, key(up, down), axes[2 * i + 1])];
    });
    return {axes: [...held, ...axes.slice(4)].map((axis) => Math.round(1000 * axis) / 1000 + 0), buttons};
  }

  gamepads() {
    return [...(navigator.getGamepads?.() ?? [])].filter((gamepad) => gamepad?.connected);
  }

  gamepad() {
    return this.gamepads().find(({mapping}) => mapping === "standard");
  }

  /** Return the line about gamepads below the sticks. */
  greeting() {
    const gamepad = this.gamepad(), [other] = this.gamepads();
    return gamepad ? `Gamepad: ${gamepad.id}` : other ? `${UNKNOWN}${other.id}. ${NO_GAMEPAD}` : NO_GAMEPAD;
  }

  /** Send changes at once, and repeat held sticks regularly. */
  update() {
    const state = this.read(), text = JSON.stringify(state), now = performance.now();
    const isHeld = [...state.axes, ...state.buttons].some((value) => value !== 0);
    if (text !== this.sent || (isHeld && now - this.sentAt >= REPEAT - 10)) {
      if (text !== this.sent) this.changedAt = now;
      this.sent = text;
      this.sentAt = now;
      if (!this.trouble) send(this.model, {type: "sticks", ...state});
    }
    this.show(state, now);
  }

  show({axes}, now) {
    this.pads.forEach((pad, i) => pad.show(axes[2 * i], axes[2 * i + 1]));
    const status = this.trouble || this.greeting();
    if (this.status.textContent !== status) this.status.textContent = status;
    const words = inWords(axes);
    const isCalm = this.changedAt > 0 && now - this.changedAt > CALM;
    if (isCalm && this.aloud.textContent !== words) this.aloud.textContent = words;
  }

  // A gamepad sends no events, so it is read at every animation frame.
  tick() {
    this.request = this.gamepad() ? requestAnimationFrame(this.tick) : 0;
    if (this.request) this.update();
  }

  end(trouble) {
    this.trouble = trouble;
    this.box.classList.add("tank-joystick-ended");
  }

  dispose() {
    this.unwatch();
    this.model.off("change:ended", this.onEnded);
    cancelAnimationFrame(this.request);
    clearInterval(this.timer);
    this.letGo();
    window.removeEventListener("blur", this.letGo);
    window.removeEventListener("pagehide", this.letGo);
    document.removeEventListener("visibilitychange", this.onHidden);
  }
}

export default showing(CellView);
