// The page of tutorial/view/web.py: a meshcat viewer that connects to the program, and reconnects when it is restarted.
// The files of every view (VIEW in tutorial/view/assets.py) precede this file in the same script.

const PATIENCE = {first: 250, most: 2000};  // between attempts to connect [ms]

const pane = makePane(document.title);
pane.id = "pane";
document.querySelector("main").prepend(pane);
const line = document.getElementById("line");
const curtain = document.getElementById("curtain");

function say(title, hint) {
  curtain.querySelector("h1").textContent = title;
  curtain.querySelector("p").textContent = hint;
  curtain.hidden = false;
}

function connect(reader, patience = PATIENCE.first) {
  const socket = new WebSocket(new URL("socket", location.href.replace(/^http/, "ws")));
  socket.binaryType = "arraybuffer";
  socket.onopen = () => { patience = PATIENCE.first; };
  socket.onmessage = ({data}) => {
    reader.read(data);
    curtain.hidden = true;
  };
  socket.onclose = () => {
    if (curtain.hidden) say("The program has ended.", "Start it again, and its view appears here.");
    setTimeout(() => connect(reader, Math.min(2 * patience, PATIENCE.most)), patience);
  };
}

function start() {
  let picture;
  try {
    picture = new Picture(pane, () => say(...TAKEN));
  } catch (error) {
    say(...noGraphics(error));
    return;
  }
  window.viewer = picture.viewer;  // for the curious, in the browser's console
  connect(new SceneReader(picture.viewer, (text) => sayBelow(line, text)));
}

start();
