// Draws the images of a topic in a cell: the page's side of tutorial/notebook/widgets/image_view.py. make.js and
// cell.js precede this file in the same module.

const PLACES = {rgb8: [0, 1, 2], bgr8: [2, 1, 0], mono8: [0, 0, 0]};  // positions of red, green and blue in a pixel
const BYTES = {rgb8: 3, bgr8: 3, mono8: 1};

/** Convert a message's bytes to the four bytes per pixel that a canvas needs. */
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

class PictureView extends FrameView {
  constructor(model, el) {
    super(model);
    this.canvas = make("canvas", "", {role: "img", "aria-label": `the images on ${model.get("title")}`});
    [this.canvas.width, this.canvas.height] = [320, 240];
    this.line = make("div", "tank-image-line");
    this.text = "";
    const box = make("div", "tank-image");
    box.append(this.canvas, this.line);
    el.append(box);
    this.onEnded();
    this.connect();
  }

  show({line, width, height, encoding}, {buffer, byteOffset, byteLength}) {
    const {canvas} = this;
    if (width) {
      if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
      const bytes = new Uint8Array(buffer, byteOffset, byteLength);
      canvas.getContext("2d").putImageData(imageData(bytes, width, height, encoding), 0, 0);
    }
    this.text = line;
    this.onEnded();
  }

  onEnded() {
    const isOver = this.isGone || this.model.get("ended");
    this.line.textContent = this.text + (isOver ? " – closed: this is its last image" : "");
  }
}

export default showing(PictureView);
