// Leaflet's layer of canvas tiles. A tile of the screen is put together from the tiles of the islands under it, and
// painted again in place when one of them has changed.

const SIZE = 256;
/** New tiles that are painted in one frame: a screen's worth at once would take longer than a frame may. */
const AT_ONCE = 4;
/** Canvases that wait to be tiles again: a screen's worth with each zoom would be a quarter of a megabyte of garbage each. */
const SPARE = 64;

/** The path of an island's tile, as the server has it; `base`: of the scene. */
export const tilePath = (base, island, zoom, x, y) => `${base}tile/${island}/${zoom}/${x}/${y}`;

/**
 * The islands' tiles under a tile of the screen: {path, version, dx, dy}, to be painted at dx, dy. `scene`: islands
 * with their versions by "zoom/x/y", offsets, the size of a cell, and what comes before the paths of its tiles.
 */
export function* tilesUnder(coords, scene) {
  const perMetre = 2 ** coords.z / scene.cell_m;
  for (const island of scene.islands) {
    const [ox, oy] = scene.offsets.get(island.id);
    const left = coords.x * SIZE - Math.round(ox * perMetre);
    const top = coords.y * SIZE + Math.round(oy * perMetre);
    for (let y = Math.floor(top / SIZE); y * SIZE < top + SIZE; ++y) {
      for (let x = Math.floor(left / SIZE); x * SIZE < left + SIZE; ++x) {
        const version = island.versions.get(`${coords.z}/${x}/${y}`);
        if (version === undefined) continue;
        yield { path: tilePath(scene.base, island.id, coords.z, x, y), version, dx: x * SIZE - left, dy: y * SIZE - top };
      }
    }
  }
}

export const IslandTiles = L.GridLayer.extend({
  initialize(images, scene, options) {
    L.GridLayer.prototype.initialize.call(this, options);
    this.images = images;
    this.scene = scene;
    this.fresh = []; // tiles that have not been painted yet: {tile, coords, done}
    this.spare = [];
    this.on("tileunload", ({ tile }) => {
      tile.coords = null;
      if (this.spare.length < SPARE) this.spare.push(tile);
    });
  },

  /** All but that the map is to be empty before another zoom: what is shown stays until that is painted. */
  getEvents() {
    const { viewprereset, ...events } = L.GridLayer.prototype.getEvents.call(this);
    return events;
  },

  /** Until it is painted whole, Leaflet keeps what another zoom shows there. */
  createTile(coords, done) {
    const tile = this.canvas();
    tile.coords = coords;
    this.fresh.push({ tile, coords, done });
    if (this.fresh.length === 1) this.paintFresh();
    return tile;
  },

  canvas() {
    const spare = this.spare.pop();
    if (!spare) return Object.assign(document.createElement("canvas"), { width: SIZE, height: SIZE });
    spare.className = spare.style.cssText = "";
    spare.parts = undefined;
    spare.getContext("2d").clearRect(0, 0, SIZE, SIZE);
    return spare;
  },

  paintFresh() {
    requestAnimationFrame(() => {
      // A canvas may be a tile elsewhere by then.
      for (const { tile, coords, done } of this.fresh.splice(0, AT_ONCE))
        if (tile.coords === coords) Promise.all(this.paint(tile)).then(() => { if (tile.coords === coords) done(null, tile); });
      if (this.fresh.length > 0) this.paintFresh();
    });
  },

  /** Paints what there is; returns promises of what is still to come, which is painted when it does. */
  paint(tile) {
    const parts = [];
    const loads = [];
    for (const { path, version, dx, dy } of tilesUnder(tile.coords, this.scene)) {
      const image = this.images.newest(path);
      if (image) parts.push({ image, dx, dy });
      loads.push(this.images.load(path, version));
    }
    const isSame = (part, i) => ["image", "dx", "dy"].every((key) => part[key] === tile.parts[i][key]);
    if (tile.parts?.length === parts.length && parts.every(isSame)) return loads;
    tile.parts = parts;
    const context = tile.getContext("2d");
    context.clearRect(0, 0, SIZE, SIZE);
    for (const { image, dx, dy } of parts) context.drawImage(image, dx, dy);
    return loads;
  },

  shown() {
    return Object.values(this._tiles ?? {}).map((entry) => entry.el).filter((tile) => tile.coords);
  },

  /** Paints again what an image is part of; all where none is named. */
  repaint(path) {
    for (const tile of this.shown()) {
      const concerns = path === undefined || [...tilesUnder(tile.coords, this.scene)].some((one) => one.path === path);
      if (concerns) this.paint(tile);
    }
  },

  /** Loads what the tiles that are shown need of another scene. */
  prepare(scene) {
    const loads = [];
    for (const tile of this.shown()) {
      for (const { path, version } of tilesUnder(tile.coords, scene)) loads.push(this.images.load(path, version));
    }
    return Promise.all(loads);
  },
});
