// Drive the page's tank without a browser. The arguments are the folder with the page's files, and the sticks' positions,
// one for each 20 ms. Print the final positions, and the time that it took [s].

import {readFileSync} from "node:fs";
import {pathToFileURL} from "node:url";
process.on("uncaughtException", ({message}) => {  // without Pyodide's line of source, which is a megabyte long
  console.error(message);
  process.exit(1);
});
const folder = process.argv[2];
const load = (name) => import(pathToFileURL(`${folder}/${name}`));
const [{default: loadMujoco}, {loadPyodide}] = await Promise.all(["mujoco.js", "pyodide.mjs"].map(load));
const [mujoco, python] = await Promise.all([loadMujoco(), loadPyodide()]);
python.unpackArchive(new Uint8Array(readFileSync(`${folder}/course.zip`)), "zip", {extractDir: "/course"});
const [, prepare] = /const PREPARE = `([^]*?)`/.exec(readFileSync(`${folder}/worker.js`, "utf8"));
python.runPython(prepare.replace("${FOLDER}", "/course"));
const setup = JSON.parse(readFileSync(`${folder}/world.json`, "utf8")).simulation;
const wire = {send() {}, announce() {}};
const program = python.pyimport("page_program").Program(mujoco, setup, wire, () => {});
const error = program.run(setup.source);
const began = performance.now();
for (const axes of JSON.parse(process.argv[3])) {
  program.sticks(axes, []);
  program.turn(0);
  for (let step = 0; step < 20; step++) program.advance();
}
const seconds = (performance.now() - began) / 1000;
console.log(JSON.stringify({error, seconds, qpos: Array.from(program.state.data.qpos)}));
