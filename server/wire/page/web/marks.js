// What single things look like on the map.

import { INK, OF_ZONES } from "./colours.js";

const FONT = "600 12px system-ui, 'DejaVu Sans', sans-serif";
const HATCH_PIXELS = 9;

/** How many pixels words take. */
export function widthOf(context, text) {
  context.font = FONT;
  return context.measureText(text).width;
}

/** Words that can be read on any ground. */
export function label(context, text, x, y, colour, underlined = false) {
  context.font = FONT;
  context.lineWidth = 3;
  context.strokeStyle = "#ffffffdd";
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
  if (underlined) context.fillRect(x, y + 2, context.measureText(text).width, 2);
}

/** Where words may stand beside a mark: from its middle to the words' nearer end, and to their baseline. */
const BESIDE = [[1, -8], [1, 16], [-1, -8], [-1, 16], [1, -22], [1, 30], [-1, -22], [-1, 30], [1, -36], [1, 44], [-1, -36], [-1, 44]];
const LINE = 13;

/**
 * Places for the words of marks, {text, x, y, …}, so that none covers another: with `left`, `baseline` and `width`. Those
 * for which there is no room are left out, the last ones first.
 */
export function besideEachOther(marks, widthOfText) {
  const taken = [];
  for (const mark of marks) {
    const width = widthOfText(mark.text);
    const at = ([side, down]) => ({ left: side > 0 ? mark.x + 11 : mark.x - 11 - width, baseline: mark.y + down, width });
    const isFree = (box) => taken.every((one) => one.left >= box.left + width || one.left + one.width <= box.left ||
      Math.abs(one.baseline - box.baseline) >= LINE);
    const box = BESIDE.map(at).find(isFree);
    if (box) taken.push({ ...mark, ...box });
  }
  return taken;
}

/** An area, hatched where nobody may go. */
export function fillZone(context, corners, kind) {
  context.save();
  context.beginPath();
  for (const corner of corners) context.lineTo(...corner);
  context.closePath();
  context.fillStyle = `${OF_ZONES[kind]}2e`;
  context.fill();
  context.strokeStyle = OF_ZONES[kind];
  context.lineWidth = 2;
  context.setLineDash(kind === "speed" ? [6, 4] : []);
  context.stroke();
  context.setLineDash([]);
  if (kind === "keep_out") {
    context.clip();
    context.lineWidth = 1;
    context.globalAlpha = 0.6;
    context.beginPath();
    const [xs, ys] = [0, 1].map((axis) => corners.map((corner) => Math.max(-50, Math.min(6000, corner[axis]))));
    const [top, bottom] = [Math.min(...ys), Math.max(...ys)];
    for (let x = Math.min(...xs) - (bottom - top); x < Math.max(...xs); x += HATCH_PIXELS) {
      context.moveTo(x, bottom);
      context.lineTo(x + bottom - top, top);
    }
    context.stroke();
  }
  context.restore();
}

/** A place, and which way it faces. */
export function drawPin(context, [x, y], yaw, name) {
  context.fillStyle = INK;
  context.strokeStyle = "#fff";
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x, y);
  context.bezierCurveTo(x - 11, y - 12, x - 7, y - 22, x, y - 22);
  context.bezierCurveTo(x + 7, y - 22, x + 11, y - 12, x, y);
  context.fill();
  context.stroke();
  context.fillStyle = "#fff";
  context.beginPath();
  context.arc(x, y - 14, 3, 0, 7);
  context.fill();
  context.strokeStyle = INK;
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x + 20 * Math.cos(yaw), y - 20 * Math.sin(yaw));
  context.stroke();
  label(context, name, x + 11, y - 13, INK);
}

/** From where it is seen, and which way where that is known; the larger, the more would be seen. */
export function drawFrontier(context, [x, y], gain, yaw = null) {
  const radius = 3 + Math.min(8, Math.sqrt(gain));
  context.beginPath();
  context.arc(x, y, radius, 0, 7);
  if (yaw !== null) {
    context.moveTo(x + radius * Math.cos(yaw), y - radius * Math.sin(yaw));
    context.lineTo(x + (radius + 6) * Math.cos(yaw), y - (radius + 6) * Math.sin(yaw));
  }
  context.stroke();
}

/** The way that a robot is to drive: dots, on white so that they are seen on walls. */
export function drawWay(context, points, colour) {
  context.lineCap = "round";
  for (const [style, width] of [["#ffffffcc", 6], [colour, 3.5]]) {
    context.strokeStyle = style;
    context.lineWidth = width;
    context.setLineDash([0.1, 8]);
    context.beginPath();
    for (const point of points) context.lineTo(...point);
    context.stroke();
  }
  context.setLineDash([]);
  context.lineCap = "butt";
  context.strokeStyle = colour;
}

/** Where a robot is to look, and which way, in the colour of its way. */
export function drawGoal(context, [x, y], yaw) {
  context.lineWidth = 2.5;
  context.beginPath();
  context.arc(x, y, 8, 0, 7);
  context.moveTo(x + 8 * Math.cos(yaw), y - 8 * Math.sin(yaw));
  context.lineTo(x + 18 * Math.cos(yaw), y - 18 * Math.sin(yaw));
  context.stroke();
}

/** A robot, and which way it faces. */
export function drawRobot(context, [x, y], yaw, colour) {
  context.save();
  context.translate(x, y);
  context.rotate(-yaw);
  context.beginPath();
  context.moveTo(11, 0);
  context.lineTo(-7, 7);
  context.lineTo(-3, 0);
  context.lineTo(-7, -7);
  context.closePath();
  context.fillStyle = colour;
  context.strokeStyle = "#fff";
  context.lineWidth = 1.5;
  context.fill();
  context.stroke();
  context.restore();
}
