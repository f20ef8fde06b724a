// One program of the page, in a thread of its own: Python, MuJoCo, and the course's files.

import loadMujoco from "./mujoco.js";
import {loadPyodide} from "./pyodide.mjs";

const TURN = 16;  // from one turn of the program to the next [ms]
const FOLDER = "/course";

const PREPARE = `
import os, sys
sys.path.insert(0, "${FOLDER}")
sys.dont_write_bytecode = True  # a file that changes twice in a second would be taken for the old one
os.register_at_fork = lambda **_: None  # nothing is forked in a browser
`;

const bytes = async (name) => new Uint8Array(await (await fetch(new URL(name, import.meta.url))).arrayBuffer());

let name, channel, program;  // the last: what of Python's is called, looked up once

/** What the program is given to reach the others. */
const wire = {
  send: (topic, type, data) => channel.postMessage({from: name, topic, type, data: data.toJs()}),
  announce: (described) => channel.postMessage({from: name, described}),
};

const commands = {
  async start({setup, wireName}) {
    name = setup.node;
    const part = async (what, promise) => {
      const result = await promise;
      postMessage({type: "loaded", what});
      return result;
    };
    const log = (text) => postMessage({type: "log", text});
    const [mujoco, python, files] = await Promise.all([
      part("MuJoCo", loadMujoco()),
      part("Python", loadPyodide({stdout: log, stderr: log})),
      part("the course", bytes("course.zip")),
    ]);
    python.unpackArchive(files, "zip", {extractDir: FOLDER});
    python.runPython(PREPARE);
    channel = new BroadcastChannel(wireName);
    const say = (text) => postMessage({type: "line", text});
    const made = python.pyimport("page_program").Program(mujoco, setup, wire, say);
    program = {data: made.state.data, wire: made.wire};
    for (const method of ["run", "reset", "turn", "sticks", "joints", "steps"]) program[method] = made[method];
    channel.onmessage = ({data}) => hear(data);
    channel.postMessage({from: name, hello: true});
    postMessage({type: "ready"});  // first: the page ends a program that does not answer only once it is ready
    report("run", program.run(setup.source));
    turn();
  },
  run: ({source}) => report("run", program.run(source)),
  reset: () => report("reset", program.reset()),
  sticks: ({axes, buttons}) => program.sticks(axes, buttons),
  ping: () => postMessage({type: "pong"}),
};

let last = Promise.resolve();  // one command after the other: what comes while the program starts, waits

onmessage = ({data}) => {
  last = last.then(() => commands[data.type](data)).catch(({message}) => postMessage({type: "broken", text: message}));
};

/** Take what another program says. */
function hear({from, topic, type, data, described, hello}) {
  if (topic) program.wire.receive(topic, type, data);
  else if (described) program.wire.hear(from, described);
  else if (hello) wire.announce(program.wire.described());
}

function report(after, error) {
  postMessage({type: "result", after, error});
}

function turn() {
  const error = program.turn(performance.now() / 1000);
  if (error) report("turn", error);
  const {data: {xpos, xmat}} = program;
  postMessage({type: "state", xpos: xpos.slice(), xmat: xmat.slice(), step: program.steps(), joints: program.joints()});
  setTimeout(turn, TURN);
}
