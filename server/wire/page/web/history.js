// The slider over what was: the map as it was at each of the journal's snapshots, and between these what had been
// mapped by a time.

const RETRY_MS = 1000;
/** Of the slider's length: so near a snapshot it is taken. */
const NEAR = 0.015;

const element = (id) => document.getElementById(id);
const pause = (ms) => new Promise((resolve) => { setTimeout(resolve, ms); });

const clock = (tenths) => {
  const seconds = Math.round(tenths / 10);
  const two = (number) => String(number).padStart(2, "0");
  const hours = Math.floor(seconds / 3600);
  return `${hours > 0 ? `${hours}:` : ""}${two(Math.floor(seconds / 60) % 60)}:${two(seconds % 60)}`;
};

export class History {
  /**
   * `changed()`: something else is looked at. `open(past)`: makes the server's answer of /past/SNAPSHOT a map that can
   * be drawn.
   */
  constructor(page, open, changed) {
    this.page = page;
    this.open = open;
    this.changed = changed;
    this.until = null; // tenths of a second after the first patch: what came later is left out; null: nothing is
    this.map = null; // as it was, where that is shown
    this.wanted = null; // the snapshot of the map that is to be shown; null: as it is now
    this.snapshots = []; // that can be shown: {snapshot, time, events, end}, the oldest first
    this.end = 0;
    element("time-slider").oninput = () => this.goTo(Number(element("time-slider").value));
    element("time-now").onclick = () => this.now();
  }

  get isNow() { return this.until === null && this.wanted === null; }

  /** The islands are others, or have grown. */
  update() {
    this.end = Math.max(0, ...this.page.scene.islands.map(({ end }) => end));
    this.tell();
  }

  /** The server has other snapshots. */
  async list() {
    try {
      const answer = await fetch("past");
      if (!answer.ok) return;
      this.snapshots = (await answer.json()).filter(({ error }) => error === undefined).sort((a, b) => a.end - b.end);
    } catch {
      return; // The server is away; it tells of them when it is back.
    }
    element("time-stops").replaceChildren(...this.snapshots.map(({ end }) => Object.assign(document.createElement("option"), { value: end })));
    this.tell();
  }

  /** Another run of the server has snapshots of its own. */
  forget() {
    this.snapshots = [];
    this.now();
  }

  now() {
    const isChange = !this.isNow;
    this.until = this.wanted = this.map = this.why = null;
    this.tell();
    if (isChange) this.changed();
  }

  goTo(tenths) {
    if (tenths >= this.end) return void this.now();
    const near = this.snapshots.find(({ end }) => Math.abs(end - tenths) <= NEAR * this.end);
    this.until = near ? null : tenths;
    this.wanted = (near ?? this.snapshots.find(({ end }) => end >= tenths))?.snapshot ?? null;
    this.why = null;
    this.load();
    this.tell();
    this.changed();
  }

  /** Brings the map that is wanted, of several that were meanwhile only the last. */
  async load() {
    if (this.wanted === null) this.map = null;
    if (this.isLoading) return;
    this.isLoading = true;
    try {
      while (this.wanted !== null && this.wanted !== this.map?.snapshot) await this.fetch(this.wanted);
    } catch {
      this.now(); // The server is away.
    } finally {
      this.isLoading = false;
    }
    this.tell();
    this.changed();
  }

  async fetch(snapshot) {
    const answer = await fetch(`past/${snapshot}`);
    if (answer.status === 503) return void await pause(RETRY_MS);
    const content = await answer.json();
    const map = answer.ok ? await this.open(content) : null;
    if (this.wanted !== snapshot) return;
    if (map) {
      this.map = map;
      return;
    }
    this.now();
    this.why = content.error;
    this.snapshots = this.snapshots.filter((one) => one.snapshot !== snapshot);
  }

  tell() {
    const slider = element("time-slider");
    slider.max = this.end;
    if (this.isNow) slider.value = this.end;
    element("time-text").textContent = this.text();
    element("time-now").disabled = this.isNow;
    element("map").classList.toggle("past", this.until !== null);
  }

  text() {
    if (this.why) return this.why;
    if (this.wanted !== null && this.wanted !== this.map?.snapshot) return "reading …";
    if (this.isNow) return `now (${clock(this.end)})`;
    if (this.until !== null) return `${clock(this.until)} of ${clock(this.end)}`;
    return `as it was at ${clock(this.snapshots.find(({ snapshot }) => snapshot === this.wanted)?.end ?? 0)}`;
  }

  shows(time) { return this.until === null || time <= this.until; }

  /** Where each robot was: as the snapshot tells, or by its patches: {name, at: [island, x, y, yaw]}. */
  robots() {
    const { scene, robots } = this.page.view;
    if (this.until === null) return robots;
    const newest = new Map();
    for (const { id } of scene.islands) {
      const data = this.page.patches.of(id, scene.base);
      if (!data) continue;
      for (let i = 0; i < data.x.length; ++i) {
        if (data.robot[i] < 0 || data.time[i] > this.until) continue;
        const name = data.robots[data.robot[i]];
        if (data.time[i] < (newest.get(name)?.time ?? -1)) continue;
        newest.set(name, { name, time: data.time[i], at: [id, data.x[i], data.y[i], data.yaw[i]] });
      }
    }
    return [...newest.values()];
  }
}
