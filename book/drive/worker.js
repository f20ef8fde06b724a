// One program of the page, in its own thread: Python, MuJoCo, and the course's files.

import loadMujoco from "./mujoco.js";
import {loadPyodide} from "./pyodide.mjs";

const TURN = 16;  // [ms] between turns of the program

const PREPARE = `
import os, sys
sys.path.insert(0, "/course")
sys.dont_write_bytecode = True  # Python would use a stale .pyc file if a file changes twice within a second
os.register_at_fork = lambda **_: None  # nothing is forked in a browser
`;

let name, channel, program;  // program: the Python functions that are called, looked up once

const say = (what, value) => postMessage([what, value]);

/** The functions that send messages to the page's other programs. */
const wire = {
  send: (topic, type, guid, data) => channel.postMessage({from: name, topic, type, guid, data: data.toJs()}),
  announce: (described) => channel.postMessage({from: name, described: described.toJs()}),
};

const commands = {
  async start({setup, wireName}) {
    name = setup.node;
    const part = (what, promise) => promise.then((made) => { say("loaded", what); return made; });
    const log = (text) => say("log", text);
    const [mujoco, python, files] = await Promise.all([
      part("MuJoCo", loadMujoco()),
      part("Python", loadPyodide({stdout: log, stderr: log})),
      part("the course", fetch(new URL("course.zip", import.meta.url)).then((answer) => answer.arrayBuffer())),
    ]);
    python.unpackArchive(files, "zip", {extractDir: "/course"});
    python.runPython(PREPARE);
    channel = new BroadcastChannel(wireName);
    const {state, wire: {deliver, hear, tell}, run, reset, turn: step, sticks} =
      python.pyimport("page_program").Program(mujoco, setup, wire, (text) => say("line", text));
    program = {data: state.data, run, reset, step, sticks};
    channel.onmessage = ({data: {from, guid, data, described, hello}}) => {
      if (guid) deliver(guid, python.toPy(data));
      else if (described) hear(from, python.toPy(described));
      else if (hello) tell();
    };
    channel.postMessage({from: name, hello: true});
    say("ready");  // before `run`: only now does the page start to watch for a stuck program
    commands.run(setup);
    turn();
  },
  run: ({source}) => say("error", program.run(source)),
  reset: () => say("error", program.reset()),
  sticks: ({axes, buttons}) => program.sticks(axes, buttons),
};

let last = Promise.resolve();  // runs one command after another: commands wait while the program starts

onmessage = ({data}) => {
  last = last.then(() => commands[data.type](data)).catch(({message}) => say("broken", message));
};

function turn() {
  const [error, step, joints] = program.step(performance.now() / 1000);
  if (error) say("error", error);
  const {data: {xpos, xmat}} = program;
  say("state", {xpos: xpos.slice(), xmat: xmat.slice(), step, joints});
  setTimeout(turn, TURN);
}
