// Orders: what will change is shown, somebody says yes, and the server's answer is told.

import { isSimple, pointsInPatches } from "./drawing.js";
import { keyOf, signedOrder } from "./sign.js";

const WORDS = {
  unsigned: "this server takes signed orders only",
  unknown_sender: "no such operator",
  forged: "the key is another than the server's",
  replayed: "an order with a later time has been taken already",
  not_accepted: "it is not accepted (any more)",
  no_such_closure: "there is no such closure",
  not_forbidden: "it is not forbidden",
  not_dropped: "the robot is not dropped",
  unknown_robot: "there is no such robot",
  frozen: "the map is frozen",
  journal_full: "the disk is full",
  bad_polygon: "its sides cross or touch, or it has no area",
  bad_name: "a name has 1 to 48 letters, digits, spaces, '.', '_' and '-', and begins and ends with a letter or digit",
  name_taken: "another place or zone has this name",
  no_such_name: "there is none of this name (any more)",
  off_the_map: "it is too far from everything that is mapped",
  other_island: "its corners are on several islands",
  unknown_patch: "the map has changed meanwhile: draw it again",
  no_manifold: "the server makes maps of features, which have no patches for this",
  too_many_annotations: "there are as many places and zones as there may be",
  not_finished: "robots are placed on finished maps only (--frozen)",
  absurd_value: "a number is none that can be",
};

const element = (id) => document.getElementById(id);

const counted = (number, one, many = `${one}s`) => `${number} ${number === 1 ? one : many}`;

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
  const answer = await fetch(`preview?${new URLSearchParams(query)}`);
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

async function linesOf(order) {
  if (order.verb === "erase") return ["Paths heed it no longer."];
  if (order.verb === "withdraw") {
    const changes = await preview({ closure: order.closure });
    return changes ? withdrawalLines(changes) : [];
  }
  if (order.verb === "drop") {
    const changes = await preview({ robot: order.robot });
    return changes ? [`Leaves out ${counted(changes.patches, "patch", "patches")} and ${counted(changes.relations, "relation")}.`,
      "What the robot sends from now on is left out too, until it is allowed again."] : [];
  }
  if (order.verb === "forbid") return ["It will not be accepted, however it is found again, until it is allowed."];
  if (order.verb === "refine") return ["The whole map is fitted once more."];
  return order.robot ? ["What the robot sends from now on is taken again."] : ["It may be accepted again, if it is found again."];
}

const titleOf = (order) => {
  const what = order.name ?? order.robot ?? (order.closure === undefined ? "the map" : `closure ${order.closure}`);
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
    const answer = await fetch("command", { method: "POST", body, headers: { "Content-Type": type } });
    const content = await answer.json();
    return answer.ok ? { done: true, words: "Done." } : { done: false, words: `Refused: ${WORDS[content.error] ?? content.error}.` };
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

/** Asks whether an order is meant, with what it will change; sends it if so. */
export async function ask(order, about) {
  open(titleOf(order), about, () => order, () => {});
  showLines(await linesOf(order));
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
