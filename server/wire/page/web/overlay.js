// All that is drawn above the tiles: patches, relations, trails, places and zones, drawn again when they or the view
// change, over several frames; and what moves, drawn again several times a second.

import { PatientCanvas, QuickCanvas } from "./canvases.js";
import { DASHES, INK, OF_CLOSURES, OF_ORIGINS, OF_VERDICTS, OF_ZONES, ofRobot } from "./colours.js";
import { besideEachOther, drawFrontier, drawGoal, drawPin, drawRobot, drawWay, fillZone, label, widthOf } from "./marks.js";
import { OF_ORDERS } from "./words.js";

/** Patches are drawn with their headings where this many pixels are a metre, or more. */
const HEADING_SCALE = 6;
/** Steps of trails are left out where they are fewer pixels apart. */
const LEAST_STEP = 3;
/** Patches and relations that are drawn at a time. */
const PIECE = 256;
/** Closures, with their numbers. */
const PIECE_OF_LABELS = 16;
/** Of a robot that may be elsewhere by now. */
const FAINT = 0.45;
/** How long a sighting is seen on the map, in the time of the log. */
const SIGHTING_S = 30;

export const Overlay = L.Layer.extend({
  initialize(world) {
    this.world = world;
  },

  onAdd(map) {
    this.still = new PatientCanvas(map, (view) => this.drawStill(view));
    this.moving = new QuickCanvas(map);
    map.on("move zoom viewreset resize", () => {
      this.still.moved();
      this.moving.moved();
      this.askFrame();
    });
    map.on("zoom", () => { this.rests = true; }); // its frame has tiles to make
    this.redraw(true);
  },

  /** At the next frame; the still part too where it has changed. */
  redraw(alsoStill = false) {
    this.still.isOld ||= alsoStill;
    this.moving.isOld = true;
    this.askFrame();
  },

  askFrame() {
    if (this.asked || (this.still.isWhole && !this.moving.isOld)) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      if (this.rests) {
        this.rests = false;
        return void this.askFrame();
      }
      const begun = performance.now();
      if (!this.still.isWhole) this.still.work(this.world.view.scene.offsets);
      if (this.moving.isOld) this.drawMoving();
      this.frame_ms = performance.now() - begun;
      if (!this.still.isWhole) this.askFrame();
    });
  },

  * drawStill(view) {
    const { show, history } = this.world;
    const { scene } = this.world.view;
    const isPart = history.until !== null;
    for (const island of isPart || show.patches || show.relations ? scene.islands : []) {
      const data = this.world.patches.of(island.id, scene.base);
      const at = view.place(island.id);
      if (!data || !at) continue;
      if (show.relations) yield* this.drawRelations(view, data, at);
      if (isPart || show.patches) yield* this.drawPatches(view, data, at);
    }
    if (show.trails && !isPart) yield* this.drawTrails(view);
    if (show.annotations) yield* this.drawAnnotations(view);
    if (show.closures && history.isNow) yield* this.drawClosures(view);
    if (show.asked && history.isNow) yield* this.drawAsked(view);
    if (show.exploration && history.isNow) yield* this.drawExploration(view);
  },

  /** Zones as areas, hatched where nobody may go; places as pins. */
  * drawAnnotations({ context, place }) {
    for (const { kind, name, island, points, max_speed, lost } of this.world.view.annotations) {
      yield;
      const at = place(island);
      if (!at || lost || points.length === 0) continue;
      const corners = points.map(([x, y]) => at(x, y));
      if (kind === "place") {
        drawPin(context, corners[0], points[0][2], name);
        continue;
      }
      fillZone(context, corners, kind);
      const [x, y] = middle(corners);
      const text = kind === "speed" ? `${name}: ${max_speed} m/s` : name;
      label(context, text, x - widthOf(context, text) / 2, y + 4, OF_ZONES[kind]);
    }
  },

  /** Ways that robots asked for lately, and frontiers with what would be seen there. */
  * drawAsked({ context, place }) {
    for (const { asker, kind, island, points } of this.world.asked) {
      yield;
      const at = place(island);
      if (!at) continue;
      context.strokeStyle = context.fillStyle = ofRobot(asker.toUpperCase(), this.world.names);
      context.lineWidth = 2.5;
      if (kind === "frontiers") {
        for (const [x, y, gain] of points) drawFrontier(context, at(x, y), gain);
        continue;
      }
      context.setLineDash([9, 5]);
      context.beginPath();
      for (const [x, y] of points) context.lineTo(...at(x, y));
      context.stroke();
      context.setLineDash([]);
      const last = points[points.length - 1];
      if (last) label(context, `${asker}: ${kind.replaceAll("_", " ")}`, at(...last)[0] + 8, at(...last)[1] + 4, INK);
    }
  },

  /** Each where the first of its relations is, with its number where there is room for it. */
  * drawClosures({ context, place }) {
    const taken = []; // boxes of numbers
    let drawn = 0;
    const { closures, marked } = this.world;
    const inOrder = [...closures.filter(({ id }) => id === marked), ...closures.filter(({ id }) => id !== marked)];
    for (const { id, kind, line } of inOrder) {
      const at = line && place(line[0]);
      if (!at) continue;
      const [[x0, y0], [x1, y1]] = [at(line[1], line[2]), at(line[3], line[4])];
      const isMarked = id === marked;
      context.strokeStyle = context.fillStyle = OF_CLOSURES;
      context.lineWidth = (kind === "merge" ? 3 : 1.5) + (isMarked ? 2 : 0);
      context.setLineDash(kind === "merge" ? [] : [6, 4]);
      context.beginPath();
      context.moveTo(x0, y0);
      context.lineTo(x1, y1);
      context.stroke();
      context.setLineDash([]);
      context.beginPath();
      for (const [x, y] of [[x0, y0], [x1, y1]]) context.arc(x, y, isMarked ? 5 : 3, 0, 7);
      context.fill();
      const [x, y, text] = [(x0 + x1) / 2 + 6, (y0 + y1) / 2 - 5, `${kind} ${id}`];
      const right = x + widthOf(context, text);
      const isFree = taken.every((box) => right < box[0] || x > box[1] || Math.abs(y - box[2]) > 13);
      if (isFree) label(context, text, x, y, OF_CLOSURES, isMarked);
      if (isFree) taken.push([x, right, y]);
      if (++drawn % PIECE_OF_LABELS === 0) yield;
    }
  },

  /** Frontiers; where each robot that explores is sent, by which way, and why it is to wait there. */
  * drawExploration({ context, place }) {
    const { exploration, names } = this.world;
    if (!exploration) return;
    context.strokeStyle = "#5b6770";
    context.lineWidth = 1.5;
    for (const [island, x, y, yaw, gain] of exploration.frontiers) {
      const at = place(island);
      if (at) drawFrontier(context, at(x, y), gain, yaw);
    }
    yield;
    for (const { robot, reason, island, goal, way } of exploration.goals) {
      const at = place(island);
      if (!at) continue;
      drawWay(context, way.map(([x, y]) => at(x, y)), ofRobot(robot, names));
      if (goal) drawGoal(context, at(goal[0], goal[1]), goal[2]);
      const words = OF_ORDERS[reason];
      const [x, y] = way.length > 0 ? at(...way[way.length - 1]) : [NaN, NaN];
      if (reason !== "frontier" && way.length > 0) label(context, `${robot} ${words}`, x + 8, y + 14, INK);
      yield;
    }
  },

  * drawRelations({ context, width, height }, data, at) {
    for (const [origin, relations] of data.ofOrigin) {
      for (let begin = 0; begin < relations.length; begin += PIECE) {
        context.lineWidth = 1;
        context.globalAlpha = 0.6;
        context.strokeStyle = OF_ORIGINS[origin];
        context.beginPath();
        for (const i of relations.subarray(begin, begin + PIECE)) {
          if (!this.wasThere(data, i)) continue;
          const [x0, y0] = at(data.x[data.a[i]], data.y[data.a[i]]);
          const [x1, y1] = at(data.x[data.b[i]], data.y[data.b[i]]);
          if (Math.max(x0, x1) < 0 || Math.max(y0, y1) < 0 || Math.min(x0, x1) > width || Math.min(y0, y1) > height) continue;
          context.moveTo(x0, y0);
          context.lineTo(x1, y1);
        }
        context.stroke();
        context.globalAlpha = 1;
        yield;
      }
    }
  },

  /** Whether a relation was on the map at the time that is looked at. */
  wasThere(data, relation) {
    const { history } = this.world;
    if (history.until === null) return true;
    return history.shows(data.time[data.a[relation]]) && history.shows(data.time[data.b[relation]]);
  },

  * drawPatches({ context, scale, width, height }, data, at) {
    const size = scale < HEADING_SCALE ? 2 : 4;
    const tick = scale < HEADING_SCALE ? 0 : 9;
    for (const [robot, patches] of data.ofRobot) {
      for (let begin = 0; begin < patches.length; begin += PIECE) {
        context.fillStyle = context.strokeStyle = ofRobot(data.robots[robot], this.world.names);
        context.lineWidth = 1;
        context.beginPath();
        for (const i of patches.subarray(begin, begin + PIECE)) {
          if (!this.world.history.shows(data.time[i])) continue;
          const [x, y] = at(data.x[i], data.y[i]);
          if (x < 0 || y < 0 || x > width || y > height) continue;
          context.fillRect(x - size / 2, y - size / 2, size, size);
          if (tick === 0) continue;
          context.moveTo(x, y);
          context.lineTo(x + tick * Math.cos(data.yaw[i]), y - tick * Math.sin(data.yaw[i]));
        }
        if (tick > 0) context.stroke();
        yield;
      }
    }
  },

  drawMoving() {
    const view = this.moving.begin(this.world.view.scene.offsets);
    const { show, history } = this.world;
    this.drawNames(view);
    if (show.tags) this.drawTags(view);
    if (show.sightings && history.isNow) this.drawSightings(view);
    if (history.isNow) this.drawMeeting(view);
    this.drawRobots(view, history.robots());
    this.drawDrawing(view, this.world.drawing?.now ?? this.world.drawn);
  },

  /** What is being drawn, or asked about. */
  drawDrawing({ context, place }, drawn) {
    const at = drawn && drawn.points.length > 0 && place(drawn.island);
    if (!at) return;
    const corners = drawn.points.map(([x, y]) => at(x, y));
    if (!drawn.corners) return void drawPin(context, corners[0], drawn.points[0][2], drawn.robot ?? drawn.name ?? "");
    if (corners.length > 2) fillZone(context, corners, drawn.kind);
    context.strokeStyle = OF_ZONES[drawn.kind];
    context.lineWidth = 2;
    context.beginPath();
    for (const corner of corners) context.lineTo(...corner);
    if (drawn.pointer && !drawn.replace) context.lineTo(...at(...drawn.pointer));
    context.stroke();
    context.fillStyle = "#fff";
    for (const [x, y] of corners) {
      context.fillRect(x - 4, y - 4, 8, 8);
      context.strokeRect(x - 4, y - 4, 8, 8);
    }
  },

  /** Islands' names, where there are several. */
  drawNames({ context, place }) {
    const { islands } = this.world.view.scene;
    if (islands.length < 2) return;
    for (const island of islands) {
      const [x, y] = place(island.id)(island.box[0], island.box[3]);
      label(context, `island ${island.id}`, x, y - 6, "#5b6770");
    }
  },

  * drawTrails({ context, place }) {
    for (const [name, steps] of Object.entries(this.world.view.trails)) {
      context.lineWidth = 2;
      context.globalAlpha = 0.75;
      context.strokeStyle = ofRobot(name, this.world.names);
      context.beginPath();
      let [at, before, px, py] = [null, null, 0, 0];
      steps.forEach(([island, x, y], i) => {
        if (island !== before) at = place(island);
        const isNew = island !== before;
        before = island;
        if (!at) return;
        const point = at(x, y);
        const isNear = Math.abs(point[0] - px) + Math.abs(point[1] - py) < LEAST_STEP;
        if (!isNew && isNear && i + 1 < steps.length) return;
        [px, py] = point;
        if (isNew) context.moveTo(px, py);
        else context.lineTo(px, py);
      });
      context.stroke();
      context.globalAlpha = 1;
      yield;
    }
  },

  drawTags({ context, place }) {
    for (const { barcode, at: [island, x, y] } of this.world.view.tags) {
      const [px, py] = place(island)?.(x, y) ?? [NaN, NaN];
      context.fillStyle = INK;
      context.fillRect(px - 4, py - 4, 8, 8);
      context.fillStyle = "#fff";
      context.fillRect(px - 2, py - 2, 4, 4);
      label(context, `#${barcode}`, px + 7, py + 4, INK);
    }
  },

  /** Those of the last half minute, the older the fainter. */
  drawSightings({ context, place }) {
    const { sightings, status } = this.world;
    context.lineWidth = 1.5;
    sightings.forEach(({ verdict, ray, time }) => {
      const fresh = 1 - ((status?.time ?? time) - time) / SIGHTING_S;
      const at = ray && fresh > 0 && place(ray[0]);
      if (!at) return;
      context.globalAlpha = Math.min(1, 0.1 + 0.9 * fresh);
      const [x0, y0] = at(ray[1], ray[2]);
      const [x1, y1] = at(ray[3], ray[4]);
      context.strokeStyle = OF_VERDICTS[verdict];
      context.setLineDash(DASHES[verdict]);
      context.beginPath();
      context.moveTo(x0, y0);
      context.lineTo(x1, y1);
      context.stroke();
      context.setLineDash([]);
      context.beginPath();
      if (verdict === "refused") {
        context.moveTo(x1 - 4, y1 - 4);
        context.lineTo(x1 + 4, y1 + 4);
        context.moveTo(x1 - 4, y1 + 4);
        context.lineTo(x1 + 4, y1 - 4);
      } else {
        context.arc(x1, y1, 3, 0, 7);
      }
      context.stroke();
    });
    context.globalAlpha = 1;
  },

  drawMeeting({ context, place }) {
    for (const { robot, at: [island, x, y] } of this.world.meeting?.places ?? []) {
      const at = place(island);
      if (!at) continue;
      const [px, py] = at(x, y);
      context.strokeStyle = ofRobot(robot, this.world.names);
      context.lineWidth = 2;
      context.setLineDash([3, 3]);
      context.beginPath();
      context.arc(px, py, 12, 0, 7);
      context.stroke();
      context.setLineDash([]);
      label(context, `${robot} to meet here`, px + 15, py + 4, INK);
    }
  },

  /** Those that have not been heard since the server's start are faint: they stand where they were then. */
  drawRobots({ context, place }, robots) {
    const shown = [];
    for (const { name, heard, at: [island, x, y, yaw] } of robots) {
      const at = place(island);
      if (!at) continue;
      const [px, py] = at(x, y);
      context.globalAlpha = heard === false ? FAINT : 1;
      drawRobot(context, [px, py], yaw, ofRobot(name, this.world.names));
      shown.push({ text: heard === false ? `${name}: not heard yet` : name, name, x: px, y: py });
    }
    context.globalAlpha = 1;
    shown.sort((a, b) => (b.name === this.world.followed) - (a.name === this.world.followed));
    this.labels = besideEachOther(shown, (text) => this.widthOf(context, text));
    for (const { text, name, left, baseline } of this.labels) label(context, text, left, baseline, INK, this.world.followed === name);
  },

  /** Measured once. */
  widthOf(context, text) {
    this.widths ??= new Map();
    if (!this.widths.has(text)) this.widths.set(text, widthOf(context, text));
    return this.widths.get(text);
  },
});

const middle = (points) => [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / points.length);
