// The lists beside the map. Rows stay the same elements while what they tell of does, so that nothing flickers and a
// button does not move away under the pointer.

import { ofRobot } from "./colours.js";
import { counted, OF_ORDERS, ofReason } from "./words.js";

const element = (id) => document.getElementById(id);

function made(tag, properties = {}, ...children) {
  const node = Object.assign(document.createElement(tag), properties);
  node.append(...children);
  return node;
}

/** Sets text where it is another, so that a selection in it stays. */
function tell(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Brings a list in line with items: `make(item)` an element for one that is new, `update(row, item)` for each. */
function bring(list, items, keyOf, make, update) {
  const rows = new Map([...list.children].map((row) => [row.dataset.key, row]));
  items.forEach((item, place) => {
    const key = String(keyOf(item));
    const row = rows.get(key) ?? make(item);
    rows.delete(key);
    row.dataset.key = key;
    if (list.children[place] !== row) list.insertBefore(row, list.children[place] ?? null);
    update(row, item);
  });
  for (const row of rows.values()) row.remove();
}

export function showLink(isUp, why) {
  const link = element("link");
  link.className = isUp ? "on" : "off";
  link.title = why;
  tell(link, isUp ? "live" : "reconnecting");
}

export function showFigures(status, islands) {
  element("no-status").hidden = true;
  element("frozen").hidden = !status.frozen;
  document.body.classList.toggle("frozen", status.frozen); // what would change the map is not offered
  const figures = [["islands", islands.length], ["patches", status.patches], ["relations", status.relations],
    ["matched", status.scans > 0 ? `${Math.round((100 * status.scans_matched) / status.scans)} %` : "–"],
    ["queued", status.queued], ["p99 latency", `${status.latency_p99_ms.toFixed(1)} ms`]];
  bring(element("figures"), figures, ([name]) => name,
    ([name]) => made("div", {}, made("dt", { textContent: name }), made("dd")),
    (row, [, value]) => tell(row.lastChild, String(value)));
}

export function showWarnings({ warnings, time }) {
  element("warnings-section").hidden = warnings.length === 0;
  tell(element("warnings-count"), warnings.length > 1 ? `(${warnings.length}, the newest first)` : "");
  const newestFirst = [...warnings].sort((a, b) => b.since - a.since);
  bring(element("warnings"), newestFirst, (warning) => `${warning.robot} ${warning.kind}`, () => made("li"),
    (row, warning) => {
      tell(row, warning.text);
      row.title = `for ${Math.round(time - warning.since)} s`;
    });
}

export function showRobots(world, follow, order) {
  const { robots, left_out } = world.status;
  element("no-robots").hidden = robots.length > 0;
  const make = (robot) => {
    const name = made("button", { type: "button", className: "robot", textContent: robot.name, title: "follow" });
    name.onclick = () => follow(robot.name);
    const act = made("button", { type: "button", className: "order" });
    act.onclick = () => order({ verb: act.dataset.verb, robot: robot.name });
    const here = made("button", { type: "button", textContent: "Place", title: "say where it is" });
    here.onclick = () => world.drawing.begin("pose", { robot: robot.name });
    return made("tr", {}, made("td", {}, name), made("td"), made("td", {}, act, here));
  };
  bring(element("robots"), robots, (robot) => robot.name, make, (row, robot) => {
    const [name, figures, act] = row.children;
    name.firstChild.style.setProperty("--colour", ofRobot(robot.name, world.names));
    row.className = world.followed === robot.name ? "followed" : "";
    const silent_s = world.status.time - robot.heard;
    const told = world.exploration?.goals.find((goal) => goal.robot === robot.name);
    const isDropped = left_out.includes(robot.name);
    const heard = robot.heard === 0 ? "not heard since the server's start" : silent_s > 5 ? `silent for ${Math.round(silent_s)} s`
      : `${robot.scan_hz.toFixed(1)} scans/s, ${Math.round(100 * robot.matched)} % matched${told ? `; ${OF_ORDERS[told.reason]}` : ""}`;
    tell(figures, isDropped ? `dropped; ${heard}` : heard);
    const verb = isDropped ? "allow" : "drop";
    act.firstChild.dataset.verb = verb;
    tell(act.firstChild, verb === "drop" ? "Drop" : "Allow");
    act.lastChild.hidden = !world.status.frozen;
  });
}

const KINDS = { place: "place", keep_out: "keep-out zone", speed: "speed zone" };

function annotationText(annotation) {
  const words = [KINDS[annotation.kind]];
  if (annotation.kind === "speed") words.push(`${annotation.max_speed} m/s`);
  if (annotation.lost) words.push("lost with a robot's data, obeyed by nobody");
  else if (annotation.moved > 0) words.push(`${annotation.moved} of its points have lost their patch`);
  return words.join("; ");
}

/** `acts`: {show, edit, erase}, each called with the place or zone. */
export function showAnnotations(annotations, acts) {
  element("no-annotations").hidden = annotations.length > 0;
  const make = () => {
    const buttons = Object.keys(acts).map((act) => made("button", { type: "button", className: act === "show" ? "" : "order",
      textContent: act[0].toUpperCase() + act.slice(1) }));
    return made("li", {}, made("div", { className: "head" }, made("span", { className: "what" }), made("span", { className: "acts" }, ...buttons)),
      made("div", { className: "more" }));
  };
  bring(element("annotations"), annotations, (one) => one.name, make, (row, one) => {
    const [head, more] = row.children;
    tell(head.firstChild, one.name);
    head.firstChild.className = `what ${one.kind}${one.lost ? " lost" : ""}`;
    tell(more, annotationText(one));
    Object.values(acts).forEach((act, i) => { head.lastChild.children[i].onclick = () => act(one); });
    head.lastChild.children[0].hidden = head.lastChild.children[1].hidden = one.lost;
  });
}

/** An island's files have its id in their names: which island is the largest may change while the list is looked at. */
export function showDownloads(islands) {
  const ranked = islands.filter(({ rank }) => rank >= 0).sort((a, b) => a.rank - b.rank).slice(0, 20);
  const link = (id, suffix, text) => made("a", { href: `download/island-${id}${suffix}`, textContent: text });
  bring(element("downloads"), ranked, ({ id }) => id, ({ id }) => made("li", {}, `island ${id}: `, link(id, ".png", "grid"), " ",
    link(id, ".yaml", "YAML"), " · floor plan ", link(id, "-plan.svg", "SVG"), " ", link(id, "-plan.dxf", "DXF"), " ",
    link(id, "-plan.geojson", "GeoJSON")), () => {});
}

/** What may be ordered of a closure. */
const actOf = ({ state, forbidden }) => (state === "accepted" ? "withdraw" : forbidden ? "allow" : "forbid");

/** `on_trial` is what is said of its state. */
const stateText = ({ state, reason }) => (reason === "on_trial" ? "on trial" : state);

function closureText(closure) {
  const words = [];
  if (closure.reason && closure.reason !== "on_trial") words.push(ofReason(closure.reason));
  if (closure.state === "accepted") {
    words.push(counted(closure.relations, "relation"));
    if (closure.patches > 0) words.push(`${counted(closure.patches, "patch", "patches")} touched`);
  } else if (closure.steps > 0) {
    words.push(`${counted(closure.steps, "step")} tried`);
  }
  return words.join("; ");
}

const percent = (share) => `${(100 * share).toFixed(1)} %`;

/** What came out where a closure was tried beside the map. */
function trialText(trial) {
  if (!trial) return "";
  const words = [`${trial.supporters} propose it`];
  if (trial.compared > 0) {
    words.push(`${trial.matched} of ${trial.compared} patches along the border match`,
      `${percent(trial.contradiction)} of hits lie in free space of the other side, ${percent(trial.own_contradiction)} in that of their own`);
  }
  if (trial.log_odds !== 0) words.push(`odds of e^${trial.log_odds.toFixed(1)} that it is no look-alike`);
  return `On trial: ${words.join("; ")}. `;
}

/** What speaks for a closure, as the server has it now. */
async function showEvidence({ id, trial }, node) {
  const answer = await fetch(`preview?closure=${id}`);
  if (!answer.ok) return;
  const { sightings, relations, dependent } = await answer.json();
  const listed = (counts) => Object.entries(counts).map(([word, count]) => `${count} ${word}`).join(", ") || "none";
  tell(node, `${trialText(trial)}Sightings: ${listed(sightings)}. Relations on the map: ${listed(relations)}; ` +
    `made with its help: ${dependent}.`);
}

/** `show`: brings one into view. */
export function showClosures(closures, order, show) {
  element("no-closures").hidden = closures.length > 0;
  const make = () => {
    const evidence = made("details", {}, made("summary", { textContent: "Evidence" }), made("p", { className: "more" }));
    const where = made("button", { type: "button", textContent: "Show" });
    return made("li", {}, made("div", { className: "head" }, made("span", { className: "what" }), made("span")),
      made("div", { className: "more" }), made("div", { className: "acts" }, made("span", { className: "acts" }), where), evidence);
  };
  bring(element("closures"), closures, (closure) => closure.id, make, (row, closure) => {
    const [head, more, { firstChild: acts, lastChild: where }, evidence] = row.children;
    where.hidden = !closure.line;
    where.onclick = () => show(closure);
    // Told anew while somebody reads it, as far as it is another.
    const seen = `${closure.state} ${closure.relations} ${JSON.stringify(closure.trial)}`;
    evidence.ontoggle = () => { if (evidence.open) showEvidence(closure, evidence.lastChild); };
    if (evidence.open && evidence.dataset.seen !== seen) showEvidence(closure, evidence.lastChild);
    evidence.dataset.seen = seen;
    tell(head.firstChild, `${closure.id} ${closure.kind} of ${closure.robots.join(", ")}`);
    head.lastChild.className = closure.state;
    tell(head.lastChild, stateText(closure));
    tell(more, closureText(closure));
    bring(acts, [actOf(closure)], (verb) => verb, (verb) => {
      const button = made("button", { type: "button", className: "order", textContent: verb[0].toUpperCase() + verb.slice(1) });
      button.onclick = () => order({ verb, closure: closure.id, kind: closure.kind });
      return button;
    }, () => {});
  });
}

export function showSightings(sightings) {
  bring(element("sightings"), sightings.slice(0, 30), (sighting) => sighting.number,
    () => made("li", {}, made("span"), made("span")), (row, sighting) => {
      tell(row.firstChild, `${sighting.robot} saw #${sighting.barcode}`);
      row.lastChild.className = sighting.verdict;
      tell(row.lastChild, sighting.reason.replaceAll("_", " ") || sighting.verdict);
    });
}

const HISTORY = 120;
const histories = { scans: [], latency: [] };

/** From 0 at the bottom to the largest, which is written at the top. */
function plot(canvas, values, unit) {
  const context = canvas.getContext("2d");
  const { width, height } = canvas;
  const most = Math.max(...values, 1e-9);
  context.clearRect(0, 0, width, height);
  context.fillStyle = "#5b6770";
  context.font = "10px system-ui, 'DejaVu Sans', sans-serif";
  context.fillText(`${most.toFixed(1)} ${unit}`, 3, 11);
  context.strokeStyle = "#0072b2";
  context.lineWidth = 1.5;
  context.beginPath();
  values.forEach((value, i) => {
    const x = width - ((values.length - 1 - i) * width) / (HISTORY - 1);
    const y = height - 3 - (value / most) * (height - 8);
    if (i === 0) context.moveTo(x, y);
    else context.lineTo(x, y);
  });
  context.stroke();
}

export function showRates(status) {
  const scans = status.robots.reduce((sum, robot) => sum + robot.scan_hz, 0);
  for (const [name, value, unit] of [["scans", scans, "/s"], ["latency", status.latency_p99_ms, "ms"]]) {
    histories[name].push(value);
    if (histories[name].length > HISTORY) histories[name].shift();
    plot(element(`plot-${name}`), histories[name], unit);
  }
  tell(element("rate-scans"), `${scans.toFixed(1)} scans/s of all robots, ${HISTORY / 60} minutes`);
  tell(element("rate-latency"), `${status.latency_p99_ms.toFixed(1)} ms: 99 % of events take less`);
}
