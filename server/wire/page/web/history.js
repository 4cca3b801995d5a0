// The slider over what was: the map as it is known now, but only what had been mapped by a time.

const element = (id) => document.getElementById(id);

const clock = (tenths) => {
  const seconds = Math.round(tenths / 10);
  const two = (number) => String(number).padStart(2, "0");
  const hours = Math.floor(seconds / 3600);
  return `${hours > 0 ? `${hours}:` : ""}${two(Math.floor(seconds / 60) % 60)}:${two(seconds % 60)}`;
};

export class History {
  /** `changed()`: another time is looked at. `until`: tenths of a second after the first patch; null: now. */
  constructor(page, changed) {
    this.page = page;
    this.until = null;
    this.end = 0;
    const slider = element("time-slider");
    slider.oninput = () => {
      this.until = Number(slider.value) >= this.end ? null : Number(slider.value);
      this.tell();
      changed();
    };
    element("time-now").onclick = () => {
      this.until = null;
      this.tell();
      changed();
    };
  }

  /** The islands are others, or have grown. */
  update() {
    this.end = Math.max(0, ...this.page.scene.islands.map(({ end }) => end));
    this.tell();
  }

  tell() {
    const slider = element("time-slider");
    slider.max = this.end;
    if (this.until === null) slider.value = this.end;
    element("time-text").textContent = this.until === null ? `now (${clock(this.end)})` : `${clock(this.until)} of ${clock(this.end)}`;
    element("time-now").disabled = this.until === null;
    element("map").classList.toggle("past", this.until !== null);
  }

  shows(time) { return this.until === null || time <= this.until; }

  /** Where each robot was then, by its patches: {name, at: [island, x, y, yaw]}. */
  robots() {
    const newest = new Map();
    for (const { id } of this.page.scene.islands) {
      const data = this.page.patches.of(id);
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
