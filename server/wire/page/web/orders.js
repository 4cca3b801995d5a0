// Orders: what will change is shown, somebody says yes, and the server's answer is told.

import { isSimple, pointsInPatches } from "./drawing.js";
import { keyOf, signedOrder } from "./sign.js";
import { fetched } from "./stream.js";
import { counted } from "./words.js";

const element = (id) => document.getElementById(id);

/** What an island comes to, from least to most: the sizes of its parts. */
function partsText(least, most) {
  const words = (parts) => (parts.length < 2 ? "stays whole" : `parts into ${parts.length}, of ${parts.join(", ")} patches`);
  if (least.length === most.length) return `The island ${words(least)}.`;
  return `The island ${words(least)}; if none of those stays, it ${words(most)}.`;
}

/** What withdrawing a closure would change, as sentences. */
function withdrawalLines(preview) {
  const relations = Object.entries(preview.relations).map(([origin, count]) => `${count} by ${origin}`).join(", ");
  const sightings = Object.entries(preview.sightings).map(([verdict, count]) => `${count} ${verdict}`).join(", ");
  const lines = [`Its own relations go (${relations || "none"}).`];
  if (sightings) lines.push(`Its sightings wait again (${sightings}).`);
  if (preview.dependent > 0) lines.push(`${counted(preview.dependent, "relation")} made with its help will be judged again.`);
  lines.push(partsText(preview.parts, preview.parts_at_most));
  lines.push("It is kept from coming again until it is allowed.");
  return lines;
}

async function preview(query) {
  const answer = await fetched(`preview?${new URLSearchParams(query)}`);
  return answer.ok ? answer.json() : null;
}

const metres2 = (ring) => Math.abs(ring.reduce((sum, [x, y], i) => {
  const [nextX, nextY] = ring[(i + 1) % ring.length];
  return sum + x * nextY - y * nextX;
}, 0)) / 2;

/** What is drawn, as sentences. */
function drawnLines(drawn) {
  if (drawn.kind === "pose") return ["Its next scans are looked for within two standard deviations of there.",
    "It is put there if one of them fits; if not, it stays where it is, and a warning says why."];
  if (drawn.kind === "place") return ["Robots can ask for a path to it by its name."];
  const area = `${metres2(drawn.points).toFixed(1)} m² with ${counted(drawn.points.length, "corner")}.`;
  const lines = [area, drawn.kind === "keep_out" ? "No path will lead through it." : "Paths through it tell this speed."];
  if (!isSimple(drawn.points)) lines.unshift("Its sides cross: the server will refuse it.");
  return lines;
}

const listed = (words) => (words.length < 2 ? words.join("") : `${words.slice(0, -1).join(", ")} and ${words.at(-1)}`);

/** What dropping a robot's data would change. */
function dropLines({ robot, patches, relations, closures }) {
  const onwards = `What ${robot} sends from now on begins an island of its own.`;
  if (patches === 0) return [`${robot} has contributed nothing yet.`, onwards];
  const lines = [`Leaves out ${counted(patches, "patch", "patches")} and ${counted(relations, "relation")}.`];
  const kinds = Object.entries(closures).map(([kind, count]) => counted(count, kind));
  if (kinds.length > 0) lines.push(`Relations are lost by ${listed(kinds)}: what they hold together may part.`);
  return [...lines, onwards, "All of it comes back once the robot is allowed again."];
}

/** What comes back with a robot's data. */
const allowedRobotLines = ({ left_out }) => [
  `Brings back ${counted(left_out, "patch", "patches")}, with all relations that were taken out.`, "Their islands are fitted once more."];

/** What speaks for a closure, as far as it is told by sightings. */
function sightingsText(sightings) {
  const count = Object.values(sightings).reduce((sum, one) => sum + one, 0);
  return count > 0 ? counted(count, "sighting") : "what was found in scans";
}

const forbidLines = ({ kind, sightings }) => ["The map stays as it is: nothing of this rests on it.",
  `What speaks for it (${sightingsText(sightings)}) is refused, and so is whatever proposes the same ${kind} again, until it is allowed.`];

const allowLines = ({ kind, sightings }) => ["The map stays as it is at first.",
  `What speaks for it (${sightingsText(sightings)}) is looked at again: the ${kind} is accepted if it passes a trial.`];

const refineLines = (status) => [`All ${status ? counted(status.patches, "patch", "patches") : "patches"} are matched with their neighbours ` +
  "once more, and each island is fitted to all its relations.", "No closure is accepted or withdrawn by that, and no robot need stop."];

/** Lines of what a preview says; where there is none, that. */
async function previewed(query, lines) {
  const changes = await preview(query);
  return changes ? lines(changes) : ["The server has no preview of that: it may have changed meanwhile."];
}

const OF_CLOSURES = { withdraw: withdrawalLines, forbid: forbidLines, allow: allowLines };
const OF_ROBOTS = { drop: dropLines, allow: allowedRobotLines };

async function linesOf(order, status) {
  if (order.verb === "erase") return ["Paths heed it no longer."];
  if (order.verb === "refine") return refineLines(status);
  return order.robot ? previewed({ robot: order.robot }, OF_ROBOTS[order.verb]) : previewed({ closure: order.closure }, OF_CLOSURES[order.verb]);
}

const titleOf = (order) => {
  const what = order.name ?? order.robot ?? (order.closure === undefined ? "the map" : `${order.kind ?? "closure"} ${order.closure}`);
  return `${order.verb[0].toUpperCase()}${order.verb.slice(1)} ${what}?`;
};

let lastUtime = 0;

/** Microseconds, later than at the last call. */
function nextUtime() {
  lastUtime = Math.max(lastUtime + 1, Date.now() * 1000);
  return lastUtime;
}

function bodyOf(order, about) {
  if (!about.signed) return { body: JSON.stringify(order), type: "application/json" };
  const key = keyOf(element("operator-key").value.trim());
  const operator = element("operator-name").value.trim().toUpperCase();
  if (!key || !operator) throw new Error("an operator's name, and a key of 64 hexadecimal digits");
  return { body: signedOrder(order, operator, key, nextUtime(), about.types), type: "application/octet-stream" };
}

/** Sends what `order()` makes; resolves to what became of it: {done, words}. */
async function send(order, about) {
  try {
    const { body, type } = bodyOf(await order(), about);
    const answer = await fetched("command", { method: "POST", body, headers: { "Content-Type": type } });
    const content = await answer.json();
    if (!answer.ok) return { done: false, words: `Refused: ${content.words || content.error}.` };
    return { done: true, words: content.words ? `Done: ${content.words}.` : "Done." };
  } catch (error) {
    return { done: false, words: `Not sent: ${error.message}.` };
  }
}

const TITLES = { place: "Name a place", keep_out: "Keep-out zone", speed: "Speed zone" };

/** The order that a drawing and what is filled in beside it make. */
async function orderOf(drawn) {
  const points = await pointsInPatches(drawn);
  if (drawn.kind === "pose") {
    const [[patch, x, y, yaw]] = points;
    return { verb: "initial_pose", robot: drawn.robot, patch, pose: [x, y, yaw], sigma_m: Number(element("field-sigma").value),
      sigma_rad: Number(element("field-sigma-yaw").value) * Math.PI / 180 };
  }
  const order = { verb: drawn.kind, name: element("field-name").value.trim(), replace: drawn.replace === true, points: points.map((point) => point.slice(0, 3)) };
  if (drawn.kind === "speed") order.max_speed = Number(element("field-speed").value);
  if (drawn.kind === "place") order.yaw = points[0][3];
  return order;
}

/** Asks for what is to be filled in of a drawing; sends it. `gone()`: it was sent and taken, or given up. */
export function askDrawn(drawn, about, gone) {
  const isPose = drawn.kind === "pose";
  open(isPose ? `Is ${drawn.robot} here?` : TITLES[drawn.kind], about, () => orderOf(drawn), gone);
  for (const [name, isShown] of [["name", !isPose], ["speed", drawn.kind === "speed"], ["sigma", isPose], ["sigma-yaw", isPose]])
    element(`field-${name}`).parentElement.hidden = !isShown;
  element("dialog-fields").hidden = false;
  element("field-name").value = drawn.name ?? "";
  element("field-name").readOnly = drawn.replace === true;
  element("field-speed").value = drawn.max_speed ?? 0.5;
  showLines(drawnLines(drawn));
}

/** Asks whether an order is meant, with what it will change; sends it if so. `status`: of the server, if it has told. */
export async function ask(order, about, status) {
  open(titleOf(order), about, () => order, () => {});
  const asked = element("dialog-title").textContent;
  const lines = await linesOf(order, status).catch(({ message }) => [`It is not known what this changes: ${message}.`]);
  if (element("dialog-title").textContent === asked) showLines(lines);
}

function showLines(lines) {
  const list = document.createElement("ul");
  for (const line of lines) list.appendChild(document.createElement("li")).textContent = line;
  element("dialog-text").replaceChildren(list);
}

function open(title, about, order, gone) {
  const dialog = element("dialog");
  element("dialog-title").textContent = title;
  element("dialog-fields").hidden = true;
  element("dialog-text").replaceChildren();
  element("dialog-answer").textContent = "";
  element("dialog-key").hidden = !about.signed;
  element("dialog-no").textContent = "Cancel";
  const yes = element("dialog-yes");
  yes.hidden = false;
  yes.disabled = false;
  dialog.onclose = gone;
  dialog.onkeydown = (event) => {
    if (event.key !== "Enter" || event.target.tagName !== "INPUT") return;
    event.preventDefault(); // the form's own button is the one that closes it
    if (!yes.hidden) yes.click();
  };
  dialog.showModal();
  yes.onclick = async () => {
    yes.disabled = true;
    const { done, words } = await send(order, about);
    element("dialog-answer").textContent = words;
    yes.disabled = done;
    yes.hidden = done;
    if (done) element("dialog-no").textContent = "Close";
  };
}
