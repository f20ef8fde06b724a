// Shows the SVG of tutorial/notebook/widgets/picture.py in a cell. It contains names from the network, so it is parsed,
// and only shapes and text reach the page.

const SHAPES = new Set(["svg", "g", "title", "line", "path", "polyline", "polygon", "rect", "circle", "ellipse", "text", "tspan"]);

/** Remove everything but shapes and text, and all handlers and links. */
function tidy(element) {
  for (const child of [...element.children]) {
    if (SHAPES.has(child.localName)) tidy(child);
    else child.remove();
  }
  for (const {name, value} of [...element.attributes]) {
    if (/^on/i.test(name) || /href$/i.test(name) || /url\s*\(/i.test(value)) element.removeAttribute(name);
  }
}

/** Parse a picture into an element of this page; null if the text is not an SVG. */
export function parse(text) {
  const root = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
  if (root.localName !== "svg" || root.querySelector("parsererror")) return null;
  tidy(root);
  return document.adoptNode(root);
}

/** Replace the content of a picture but keep its element, with a screen reader's focus and the pointer on it. */
function become(shown, picture) {
  for (const {name} of [...shown.attributes]) shown.removeAttribute(name);
  for (const {name, value} of [...picture.attributes]) shown.setAttribute(name, value);
  shown.replaceChildren(...picture.childNodes);
}

function render({model, el}) {
  const draw = () => {
    const shown = el.firstElementChild;
    const picture = parse(model.get("svg"));
    if (picture === null) {
      el.replaceChildren();
      return;
    }
    picture.setAttribute("role", "img");
    picture.setAttribute("aria-label", model.get("alt"));
    if (shown === null) el.replaceChildren(picture);
    else become(shown, picture);
  };
  const describe = () => el.firstElementChild?.setAttribute("aria-label", model.get("alt"));
  model.on("change:svg", draw);
  model.on("change:alt", describe);
  draw();
  return () => {
    model.off("change:svg", draw);
    model.off("change:alt", describe);
  };
}

export default {render};
