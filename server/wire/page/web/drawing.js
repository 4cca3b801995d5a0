// Places and zones, and where a robot is: drawn on the map with the pointer, and what the server is told of it.

import { readPatches } from "./patches.js";
import { fetched } from "./stream.js";

/** A click so near the first corner ends a zone; a corner so near is taken hold of. */
const NEAR_PIXELS = 10;
const MOST_CORNERS = 64;
const LEAST_CORNERS = 3;

const element = (id) => document.getElementById(id);

const HINTS = {
  place: "Press where the place is, and drag the way it faces.",
  pose: "Press where the robot is, and drag the way it faces.",
  zone: "Click the corners; click the first again, or press Enter, to end. Drag a corner to move it. Esc cancels.",
};

/** Where a point of an island's plane is, in the frame of the nearest patch: [patch, x, y, yaw]. */
export function inNearestPatch(patches, [x, y, yaw = 0]) {
  let best = -1;
  let least = Infinity;
  for (let i = 0; i < patches.x.length; ++i) {
    const distance = (patches.x[i] - x) ** 2 + (patches.y[i] - y) ** 2;
    if (patches.robot[i] < 0 || distance >= least) continue;
    [best, least] = [i, distance];
  }
  if (best < 0) return null;
  const [cos, sin] = [Math.cos(patches.yaw[best]), Math.sin(patches.yaw[best])];
  const [dx, dy] = [x - patches.x[best], y - patches.y[best]];
  const turn = yaw - patches.yaw[best];
  return [patches.id[best], cos * dx + sin * dy, cos * dy - sin * dx, Math.atan2(Math.sin(turn), Math.cos(turn))];
}

export class Drawing {
  /** `finished(drawing)`: {kind, island, points, ...} is drawn; points are [x, y] or [x, y, yaw] in the island's plane. */
  constructor(page, finished) {
    this.page = page;
    this.finished = finished;
    this.now = null;
    this.tookPress = false; // what began with the pointer's last press was for a drawing, which may have ended since
    this.held = -1;
    const map = page.map;
    map.on("click", (event) => this.click(event));
    map.on("mousedown", (event) => this.press(event));
    map.on("mousemove", (event) => this.move(event));
    map.on("mouseup", () => this.release());
    document.addEventListener("keydown", (event) => {
      if (!this.now || element("dialog").open) return;
      if (event.key === "Escape") this.cancel();
      if (event.key !== "Enter" || !this.now.corners) return;
      event.preventDefault(); // or it would answer the dialog that opens
      this.end();
    });
    element("hint-end").onclick = () => this.end();
    element("hint-cancel").onclick = () => this.cancel();
  }

  /** kind: place, keep_out, speed or pose; `more`: what else the order says, and of a zone its corners so far. */
  begin(kind, more = {}) {
    this.page.history.now(); // what is drawn is held by the map as it is
    document.activeElement?.blur(); // Enter is for the drawing, not for the button that began it
    const corners = kind === "keep_out" || kind === "speed";
    this.now = { kind, corners, island: null, points: [], ...more };
    this.held = -1;
    this.page.follow(null);
    this.page.map.doubleClickZoom.disable();
    if (!corners) this.page.map.dragging.disable();
    element("hint").hidden = false;
    this.hint();
    element("hint-end").hidden = !corners;
    this.page.map.getContainer().classList.add("drawing");
    this.page.overlay.redraw();
  }

  /** Says why something was not done; nothing: how to draw. */
  hint(why = "") {
    element("hint").classList.toggle("refusal", why !== "");
    element("hint-text").textContent = why || HINTS[this.now.corners ? "zone" : this.now.kind];
  }

  cancel() {
    this.now = null;
    this.page.map.doubleClickZoom.enable();
    this.page.map.dragging.enable();
    element("hint").hidden = true;
    this.page.map.getContainer().classList.remove("drawing");
    this.page.overlay.redraw();
  }

  end() {
    const drawn = this.now;
    if (!drawn) return;
    if (drawn.corners && drawn.points.length < LEAST_CORNERS)
      return void this.hint(`A zone needs three corners: this one has ${drawn.points.length || "none"} so far.`);
    this.cancel();
    this.finished(drawn);
  }

  /** How far a place of the screen is from an island's box, metres; 0: in it. */
  distance({ id, box }, latlng) {
    const [ox, oy] = this.page.scene.offsets.get(id);
    const [x, y] = [latlng.lng - ox, latlng.lat - oy];
    return Math.max(box[0] - x, x - box[2], box[1] - y, y - box[3], 0);
  }

  /** A point of the screen in the plane of the island that is being drawn on, or that lies there. */
  pointAt(latlng) {
    const { scene } = this.page;
    const nearest = [...scene.islands].sort((a, b) => this.distance(a, latlng) - this.distance(b, latlng))[0];
    this.now.island ??= nearest?.id ?? null;
    const offset = scene.offsets.get(this.now.island);
    return offset ? [latlng.lng - offset[0], latlng.lat - offset[1]] : null;
  }

  /** Another island than that of the drawing, where a place of the screen is on one; it is said that a corner cannot be there. */
  isElsewhere(latlng) {
    const { islands } = this.page.scene;
    const own = islands.find(({ id }) => id === this.now.island);
    if (!own || this.distance(own, latlng) === 0) return false;
    const other = islands.find((island) => this.distance(island, latlng) === 0);
    if (other) this.hint(`That is on island ${other.id}, and the zone on island ${own.id}: all its corners are on one island.`);
    return other !== undefined;
  }

  /** Which corner is at a place of the screen; -1: none. */
  cornerAt(containerPoint) {
    const offset = this.page.scene.offsets.get(this.now.island);
    if (!offset) return -1;
    return this.now.points.findIndex(([x, y]) =>
      this.page.map.latLngToContainerPoint([y + offset[1], x + offset[0]]).distanceTo(containerPoint) < NEAR_PIXELS);
  }

  click(event) {
    if (!this.now?.corners || this.moved) return;
    const corner = this.cornerAt(event.containerPoint);
    if (corner === 0 && this.now.points.length >= LEAST_CORNERS) return void this.end();
    if (this.isElsewhere(event.latlng)) return;
    const point = this.pointAt(event.latlng);
    if (corner >= 0 || !point || this.now.points.length >= MOST_CORNERS) return;
    this.now.points.push(point);
    this.hint();
    this.page.overlay.redraw();
  }

  press(event) {
    this.moved = false;
    this.tookPress = this.now !== null;
    if (!this.now) return;
    if (this.now.corners) {
      this.held = this.cornerAt(event.containerPoint);
      if (this.held >= 0) this.page.map.dragging.disable();
      return;
    }
    const point = this.pointAt(event.latlng);
    if (!point) return;
    this.now.points = [[...point, 0]];
    this.held = 0;
  }

  move(event) {
    if (!this.now) return;
    const point = this.now.island === null ? null : this.pointAt(event.latlng);
    this.now.pointer = point;
    if (this.held >= 0 && point) {
      this.moved = true;
      if (!this.now.corners) this.turn(point);
      else if (!this.isElsewhere(event.latlng)) this.moveCorner(point);
    }
    this.page.overlay.redraw();
  }

  moveCorner(point) {
    this.now.points[this.held] = point;
    this.hint();
  }

  /** Towards a point: the way that a place or a robot faces. */
  turn([x, y]) {
    const [at] = this.now.points;
    at[2] = Math.atan2(y - at[1], x - at[0]);
  }

  release() {
    const wasHeld = this.held;
    this.held = -1;
    if (!this.now || wasHeld < 0) return;
    if (this.now.corners) this.page.map.dragging.enable();
    else this.end();
  }
}

/** The points of a drawing in the frames of the patches nearest to them, as the server has them now. */
export async function pointsInPatches(drawn) {
  const answer = await fetched(`patches/${drawn.island}`);
  if (answer.status !== 200) throw new Error("the island is not on the map any more");
  const patches = readPatches(await answer.arrayBuffer());
  const points = drawn.points.map((point) => inNearestPatch(patches, point));
  if (points.includes(null)) throw new Error("there are no patches there");
  return points;
}

/** Whether no two sides of a ring cross, as the server will ask. */
export function isSimple(ring) {
  const side = ([ax, ay], [bx, by], [cx, cy]) => Math.sign((bx - ax) * (cy - ay) - (by - ay) * (cx - ax));
  const n = ring.length;
  for (let i = 0; i < n; ++i) {
    for (let j = i + 2; j < n; ++j) {
      if (i === 0 && j + 1 === n) continue;
      const [a, b, c, d] = [ring[i], ring[i + 1], ring[j], ring[(j + 1) % n]];
      if (side(a, b, c) !== side(a, b, d) && side(c, d, a) !== side(c, d, b)) return false;
    }
  }
  return n >= 3;
}
