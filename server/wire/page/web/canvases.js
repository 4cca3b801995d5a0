// Canvases above the tiles, and how islands are placed on them.

/** Of a frame: so long what takes several frames is drawn in each. */
const SLICE_MS = 4;
/** Of the view, on each side: so far the map can be dragged before a canvas is drawn again. */
const MARGIN_OF_PATIENT = 0.25;
const MARGIN_OF_QUICK = 0.1; // it is drawn several times a second anyhow

function newCanvas(pane) {
  const canvas = pane.appendChild(document.createElement("canvas"));
  canvas.style.pointerEvents = "none";
  canvas.style.transformOrigin = "0 0";
  return canvas;
}

/** Makes a canvas as large as the view and so much more on each side; clears it. Islands are where they are now. */
function begin(canvas, settings, map, offsets, margin) {
  const { x, y } = map.getSize();
  const [left, top] = [Math.round(margin * x), Math.round(margin * y)];
  const [width, height] = [x + 2 * left, y + 2 * top];
  const ratio = window.devicePixelRatio || 1;
  const [columns, rows] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== columns || canvas.height !== rows) {
    [canvas.width, canvas.height] = [columns, rows];
    [canvas.style.width, canvas.style.height] = [`${width}px`, `${height}px`];
  }
  const context = canvas.getContext("2d", settings);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  canvas.corner = map.containerPointToLatLng([-left, -top]);
  canvas.zoom = map.getZoom();
  canvas.extent = { x: width, y: height };
  const origin = map.latLngToContainerPoint([0, 0]).add([left, top]);
  const scale = map.latLngToContainerPoint([0, 1]).x - origin.x + left;
  const place = (island) => {
    const offset = offsets.get(island);
    if (!offset) return null;
    const [x0, y0] = [origin.x + scale * offset[0], origin.y - scale * offset[1]];
    return (east, north) => [x0 + scale * east, y0 - scale * north];
  };
  return { context, scale, place, width, height };
}

/** Puts a canvas where what is drawn on it is on the map now, in the size that it has there. */
function put(canvas, map) {
  if (canvas.corner) L.DomUtil.setTransform(canvas, map.latLngToLayerPoint(canvas.corner), map.getZoomScale(map.getZoom(), canvas.zoom));
}

/** Whether a canvas was drawn at the map's zoom, and still covers the view. */
function covers({ corner, zoom, extent }, map) {
  if (!corner || zoom !== map.getZoom()) return false;
  const size = map.getSize();
  const { x, y } = map.latLngToContainerPoint(corner);
  return x <= 0 && y <= 0 && x + extent.x >= size.x && y + extent.y >= size.y;
}

/** Drawn whole in one frame: for what is little. */
export class QuickCanvas {
  constructor(map) {
    this.map = map;
    this.canvas = newCanvas(map.getPane("overlayPane"));
    this.isOld = true;
  }

  /** The view is another. What is shown goes along; what leaves its margin is drawn again, and another zoom. */
  moved() {
    put(this.canvas, this.map);
    if (!covers(this.canvas, this.map)) this.isOld = true;
  }

  begin(offsets) {
    this.isOld = false;
    const view = begin(this.canvas, undefined, this.map, offsets, MARGIN_OF_QUICK);
    put(this.canvas, this.map);
    return view;
  }
}

/**
 * Drawn a little in each frame, however much it is, and shown once it is whole: till then the picture before it stays,
 * and goes with the map.
 */
export class PatientCanvas {
  /** `draw(view)`: a generator that yields after each little piece. */
  constructor(map, draw) {
    this.map = map;
    this.draw = draw;
    [this.shown, this.next] = [0, 1].map(() => newCanvas(map.getPane("overlayPane")));
    this.next.style.visibility = "hidden";
    this.isOld = true;
    this.pieces = null;
  }

  get isWhole() { return !this.isOld && !this.pieces; }

  /** The view is another. What is shown goes along; what leaves its margin is drawn again, and another zoom. */
  moved() {
    put(this.shown, this.map);
    const canvas = this.pieces ? this.next : this.shown;
    if (canvas.zoom !== this.map.getZoom()) this.pieces = null;
    if (!covers(canvas, this.map)) this.isOld = true;
  }

  /** Draws for a while, the newest there is, where what is being drawn is not to be finished first. */
  work(offsets) {
    const until = performance.now() + SLICE_MS;
    if (!this.pieces) {
      this.isOld = false;
      // Drawn by the processor, and in this frame: what a graphics processor is given is drawn some time later, all at once.
      this.view = begin(this.next, { willReadFrequently: true }, this.map, offsets, MARGIN_OF_PATIENT);
      this.pieces = this.draw(this.view);
    }
    do {
      if (this.pieces.next().done) return this.show();
      this.view.context.getImageData(0, 0, 1, 1); // not before it is drawn
    } while (performance.now() < until);
  }

  show() {
    this.pieces = null;
    [this.shown, this.next] = [this.next, this.shown];
    put(this.shown, this.map);
    this.shown.style.visibility = "visible";
    this.next.style.visibility = "hidden";
  }
}
