// The server's tiles as canvases: loaded a few at a time, coloured here, kept while there is room.

const AT_ONCE = 4;
const KEPT = 400;

/** map_server's greys to what is shown: what is unknown is not painted, so that islands may lie side by side. */
function coloured(bitmap) {
  const canvas = document.createElement("canvas");
  canvas.width = bitmap.width;
  canvas.height = bitmap.height;
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  bitmap.close(); // or its memory is held until garbage is collected
  const image = context.getImageData(0, 0, canvas.width, canvas.height);
  const pixels = new Uint32Array(image.data.buffer);
  for (let i = 0; i < pixels.length; ++i) {
    const grey = pixels[i] & 0xff;
    pixels[i] = grey === 205 ? 0 : grey > 205 ? 0xffffffff : 0xff2c251d;
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

export class Images {
  constructor(onLoaded) {
    this.onLoaded = onLoaded;
    this.kept = new Map(); // by path: {version, canvas}, the one used longest ago first
    this.waiting = new Map(); // by path: {version, done}
    this.loading = 0;
  }

  clear() {
    this.kept.clear();
    for (const entry of this.waiting.values()) entry.done();
    this.waiting.clear();
  }

  /** The newest canvas there is of a tile, of whatever version; undefined where there is none. */
  newest(path) {
    const entry = this.kept.get(path);
    if (!entry) return undefined;
    this.kept.delete(path);
    this.kept.set(path, entry);
    return entry.canvas;
  }

  /** Resolves once the tile is there in this version, or cannot be had. */
  load(path, version) {
    if (this.kept.get(path)?.version >= version) return Promise.resolve();
    const before = this.waiting.get(path);
    if (before?.version >= version) return before.promise;
    const entry = { version };
    entry.promise = new Promise((resolve) => { entry.done = resolve; });
    if (before) entry.promise.then(before.done);
    this.waiting.set(path, entry);
    this.next();
    return entry.promise;
  }

  next() {
    for (const [path, entry] of this.waiting) {
      if (this.loading >= AT_ONCE) return;
      if (entry.begun) continue;
      entry.begun = true;
      this.loading += 1;
      this.fetch(path, entry).finally(() => {
        this.loading -= 1;
        if (this.waiting.get(path) === entry) this.waiting.delete(path);
        entry.done();
        this.next();
      });
    }
  }

  async fetch(path, entry) {
    try {
      const answer = await fetch(`${path}?v=${entry.version}`);
      if (answer.status !== 200) return; // 204: its island is gone
      const canvas = coloured(await createImageBitmap(await answer.blob()));
      if (this.kept.get(path)?.version > entry.version) return;
      this.kept.delete(path);
      this.kept.set(path, { version: entry.version, canvas });
      for (const oldest of this.kept.keys()) {
        if (this.kept.size <= KEPT) break;
        this.kept.delete(oldest);
      }
      this.onLoaded(path);
    } catch {
      // The server is away: the tile is asked for again once it is back.
    }
  }
}
