// Draws the pictures of a topic in a cell: the page's side of tutorial/notebook/widgets/image_view.py. make.js and cell.js
// stand before this text in the same module.

const PLACES = {rgb8: [0, 1, 2], bgr8: [2, 1, 0], mono8: [0, 0, 0]};  // where red, green and blue are in a pixel
const BYTES = {rgb8: 3, bgr8: 3, mono8: 1};

/** Make what a canvas takes, four bytes for a pixel, of the bytes of a message. */
function imageData(bytes, width, height, encoding) {
  const image = new ImageData(width, height);
  const [red, green, blue] = PLACES[encoding];
  const size = BYTES[encoding];
  const {data} = image;
  for (let from = 0, to = 0; to < data.length; from += size, to += 4) {
    data[to] = bytes[from + red];
    data[to + 1] = bytes[from + green];
    data[to + 2] = bytes[from + blue];
    data[to + 3] = 255;
  }
  return image;
}

function render({model, el}) {
  const view = `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;
  const box = make("div", "tank-image");
  const canvas = make("canvas", "", {role: "img", "aria-label": `the pictures on ${model.get("title")}`});
  const line = make("div", "tank-image-line", {}, model.get("line"));
  [canvas.width, canvas.height] = [320, 240];
  box.append(canvas, line);
  el.append(box);

  let isGone = false;
  const say = (message) => {
    if (!isGone) send(model, {...message, view});
  };
  const suffix = () => (isGone || model.get("ended") ? " – closed: this is its last picture" : "");
  let text = model.get("line");
  const label = () => { line.textContent = text + suffix(); };
  const onMessage = (message, buffers) => {
    if (message.type !== "frame") return;
    const {width, height, encoding, frame} = message;
    const {buffer, byteOffset, byteLength} = buffers[0];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const bytes = new Uint8Array(buffer, byteOffset, byteLength);
    canvas.getContext("2d").putImageData(imageData(bytes, width, height, encoding), 0, 0);
    text = message.line;
    label();
    // Not before the browser has come to draw it: a page that is slow, or not looked at, asks for less.
    requestAnimationFrame(() => say({type: "drawn", frame}));
  };
  const onLine = () => {
    text = model.get("line");
    label();
  };
  const leave = () => say({type: "bye"});
  const hello = () => say({type: "hello"});
  const unwatch = watchKernel(
    model,
    () => { isGone = true; label(); },
    (isThere) => { if (isThere) hello(); },
  );
  model.on("msg:custom", onMessage);
  model.on("change:line", onLine);
  model.on("change:ended", label);
  window.addEventListener("pagehide", leave);
  label();
  hello();
  return () => {
    leave();
    unwatch();
    model.off("msg:custom", onMessage);
    model.off("change:line", onLine);
    model.off("change:ended", label);
    window.removeEventListener("pagehide", leave);
  };
}

export default {render};
