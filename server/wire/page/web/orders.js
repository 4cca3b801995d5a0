// Orders: what will change is shown, somebody says yes, and the server's answer is told.

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

async function linesOf(order) {
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
  const what = order.robot ?? (order.closure === undefined ? "the map" : `closure ${order.closure}`);
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

/** Sends an order; resolves to what became of it: {done, words}. */
async function send(order, about) {
  try {
    const { body, type } = bodyOf(order, about);
    const answer = await fetch("command", { method: "POST", body, headers: { "Content-Type": type } });
    const content = await answer.json();
    return answer.ok ? { done: true, words: "Done." } : { done: false, words: `Refused: ${WORDS[content.error] ?? content.error}.` };
  } catch (error) {
    return { done: false, words: `Not sent: ${error.message}.` };
  }
}

/** Asks whether an order is meant, with what it will change; sends it if so. */
export async function ask(order, about) {
  const dialog = element("dialog");
  element("dialog-title").textContent = titleOf(order);
  element("dialog-answer").textContent = "";
  element("dialog-key").hidden = !about.signed;
  element("dialog-no").textContent = "Cancel";
  const yes = element("dialog-yes");
  yes.hidden = false;
  yes.disabled = false;
  const list = document.createElement("ul");
  element("dialog-text").replaceChildren(list);
  dialog.showModal();
  for (const line of await linesOf(order)) list.appendChild(document.createElement("li")).textContent = line;
  yes.onclick = async () => {
    yes.disabled = true;
    const { done, words } = await send(order, about);
    element("dialog-answer").textContent = words;
    yes.disabled = done;
    yes.hidden = done;
    if (done) element("dialog-no").textContent = "Close";
  };
}
