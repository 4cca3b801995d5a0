// All that is drawn above the tiles, on two canvases: patches, relations and trails, drawn again when the view or they
// change, once a second at most; and what moves, drawn again several times a second.

import { DASHES, INK, OF_ORIGINS, OF_VERDICTS, ofRobot } from "./colours.js";

/** Patches are drawn with their headings where this many pixels are a metre, or more. */
const HEADING_SCALE = 6;
/** Steps of trails are left out where they are fewer pixels apart. */
const LEAST_STEP = 3;

export const Overlay = L.Layer.extend({
  initialize(world) {
    this.world = world;
  },

  onAdd(map) {
    const pane = map.getPane("overlayPane");
    this.still = pane.appendChild(document.createElement("canvas"));
    this.moving = pane.appendChild(document.createElement("canvas"));
    for (const canvas of [this.still, this.moving]) canvas.style.pointerEvents = "none";
    map.on("move zoom viewreset resize", () => this.redraw(true));
    this.redraw(true);
  },

  /** At the next frame; the still part too where it has changed. */
  redraw(alsoStill = false) {
    this.stillIsOld ||= alsoStill;
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      const begun = performance.now();
      if (this.stillIsOld) this.drawStill();
      this.stillIsOld = false;
      this.drawMoving();
      this.frame_ms = performance.now() - begun;
    });
  },

  /** A canvas as large as the view, cleared, and how islands are placed on it. */
  begin(canvas) {
    const map = this._map;
    const size = map.getSize();
    const ratio = window.devicePixelRatio || 1;
    L.DomUtil.setPosition(canvas, map.containerPointToLayerPoint([0, 0]));
    if (canvas.width !== Math.round(size.x * ratio) || canvas.height !== Math.round(size.y * ratio)) {
      canvas.width = Math.round(size.x * ratio);
      canvas.height = Math.round(size.y * ratio);
      canvas.style.width = `${size.x}px`;
      canvas.style.height = `${size.y}px`;
    }
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, size.x, size.y);
    const origin = map.latLngToContainerPoint([0, 0]);
    const scale = map.latLngToContainerPoint([0, 1]).x - origin.x;
    const place = (island) => {
      const offset = this.world.scene.offsets.get(island);
      if (!offset) return null;
      const [x0, y0] = [origin.x + scale * offset[0], origin.y - scale * offset[1]];
      return (x, y) => [x0 + scale * x, y0 - scale * y];
    };
    return { context, scale, place, width: size.x, height: size.y };
  },

  drawStill() {
    const view = this.begin(this.still);
    const { show } = this.world;
    for (const island of show.patches || show.relations ? this.world.scene.islands : []) {
      const data = this.world.patches.of(island.id);
      const at = view.place(island.id);
      if (!data || !at) continue;
      if (show.relations) this.drawRelations(view, data, at);
      if (show.patches) this.drawPatches(view, data, at);
    }
    if (show.trails) this.drawTrails(view);
  },

  drawRelations({ context, width, height }, data, at) {
    context.lineWidth = 1;
    context.globalAlpha = 0.6;
    OF_ORIGINS.forEach((colour, origin) => {
      context.strokeStyle = colour;
      context.beginPath();
      for (let i = 0; i < data.a.length; ++i) {
        if (data.origin[i] !== origin) continue;
        const [x0, y0] = at(data.x[data.a[i]], data.y[data.a[i]]);
        const [x1, y1] = at(data.x[data.b[i]], data.y[data.b[i]]);
        if (Math.max(x0, x1) < 0 || Math.max(y0, y1) < 0 || Math.min(x0, x1) > width || Math.min(y0, y1) > height) continue;
        context.moveTo(x0, y0);
        context.lineTo(x1, y1);
      }
      context.stroke();
    });
    context.globalAlpha = 1;
  },

  drawPatches({ context, scale, width, height }, data, at) {
    const colours = data.robots.map((name) => ofRobot(name, this.world.names));
    const size = scale < HEADING_SCALE ? 2 : 4;
    const tick = scale < HEADING_SCALE ? 0 : 9;
    colours.forEach((colour, robot) => {
      context.fillStyle = context.strokeStyle = colour;
      context.lineWidth = 1;
      context.beginPath();
      for (let i = 0; i < data.x.length; ++i) {
        if (data.robot[i] !== robot) continue;
        const [x, y] = at(data.x[i], data.y[i]);
        if (x < 0 || y < 0 || x > width || y > height) continue;
        context.fillRect(x - size / 2, y - size / 2, size, size);
        if (tick === 0) continue;
        context.moveTo(x, y);
        context.lineTo(x + tick * Math.cos(data.yaw[i]), y - tick * Math.sin(data.yaw[i]));
      }
      if (tick > 0) context.stroke();
    });
  },

  drawMoving() {
    const view = this.begin(this.moving);
    const { show } = this.world;
    view.context.font = "600 12px system-ui, 'DejaVu Sans', sans-serif";
    this.drawNames(view);
    if (show.tags) this.drawTags(view);
    if (show.sightings) this.drawSightings(view);
    this.drawMeeting(view);
    this.drawRobots(view);
  },

  /** Islands' names, where there are several. */
  drawNames({ context, place }) {
    if (this.world.scene.islands.length < 2) return;
    for (const island of this.world.scene.islands) {
      const [x, y] = place(island.id)(island.box[0], island.box[3]);
      label(context, `island ${island.id}`, x, y - 6, "#5b6770");
    }
  },

  drawTrails({ context, place }) {
    context.lineWidth = 2;
    context.globalAlpha = 0.75;
    for (const [name, steps] of Object.entries(this.world.trails)) {
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
    }
    context.globalAlpha = 1;
  },

  drawTags({ context, place }) {
    for (const { barcode, at: [island, x, y] } of this.world.tags) {
      const [px, py] = place(island)?.(x, y) ?? [NaN, NaN];
      context.fillStyle = INK;
      context.fillRect(px - 4, py - 4, 8, 8);
      context.fillStyle = "#fff";
      context.fillRect(px - 2, py - 2, 4, 4);
      label(context, `#${barcode}`, px + 7, py + 4, INK);
    }
  },

  drawSightings({ context, place }) {
    context.lineWidth = 1.5;
    for (const { verdict, ray } of this.world.sightings) {
      const at = ray && place(ray[0]);
      if (!at) continue;
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
    }
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

  drawRobots({ context, place }) {
    for (const { name, at: [island, x, y, yaw] } of this.world.robots) {
      const at = place(island);
      if (!at) continue;
      const [px, py] = at(x, y);
      context.save();
      context.translate(px, py);
      context.rotate(-yaw);
      context.beginPath();
      context.moveTo(11, 0);
      context.lineTo(-7, 7);
      context.lineTo(-3, 0);
      context.lineTo(-7, -7);
      context.closePath();
      context.fillStyle = ofRobot(name, this.world.names);
      context.strokeStyle = "#fff";
      context.lineWidth = 1.5;
      context.fill();
      context.stroke();
      context.restore();
      label(context, name, px + 11, py - 8, INK, this.world.followed === name);
    }
  },
});

/** Words that can be read on any ground. */
function label(context, text, x, y, colour, underlined = false) {
  context.lineWidth = 3;
  context.strokeStyle = "#ffffffdd";
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
  if (underlined) context.fillRect(x, y + 2, context.measureText(text).width, 2);
}
