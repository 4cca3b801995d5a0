// Patches and relations of an island, from the server's arrays.

/** Where in an array each value is. */
function placesOf(values) {
  const places = new Map();
  values.forEach((value, i) => {
    if (!places.has(value)) places.set(value, []);
    places.get(value).push(i);
  });
  return new Map([...places].sort(([a], [b]) => a - b).map(([value, list]) => [value, Int32Array.from(list)]));
}

/** Reads the body of /patches/ISLAND (the room's README tells the form). */
export function readPatches(buffer) {
  const [patches, relations, nameBytes] = new Uint32Array(buffer, 0, 3);
  const text = new TextDecoder().decode(new Uint8Array(buffer, 12, nameBytes));
  let at = 12 + nameBytes;
  const take = (Type, count) => {
    const values = new Type(buffer, at, count);
    at += 4 * count;
    return values;
  };
  const arrays = {
    robots: text.trimEnd().split("\n"),
    id: take(Int32Array, patches),
    robot: take(Int32Array, patches),
    x: take(Float32Array, patches),
    y: take(Float32Array, patches),
    yaw: take(Float32Array, patches),
    time: take(Int32Array, patches), // tenths of a second after the map's first patch
    a: take(Int32Array, relations),
    b: take(Int32Array, relations),
    origin: take(Int32Array, relations),
    closure: take(Int32Array, relations),
  };
  return { ...arrays, ofRobot: placesOf(arrays.robot), ofOrigin: placesOf(arrays.origin) };
}

/** Keeps the patches of the islands, once somebody wants to see them. */
export class Patches {
  constructor(onLoaded) {
    this.onLoaded = onLoaded;
    this.islands = new Map(); // {version, data} by the scene's base and the island's id
    this.busy = false;
  }

  clear() { this.islands.clear(); }

  of(island, base = "") { return this.islands.get(base + island)?.data; }

  /** Fetches what is not as new as the islands are, one island after the other. */
  async update(scene) {
    this.next = scene;
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.next) await this.fetch(this.next);
      this.onLoaded();
    } catch {
      // The server is away.
    } finally {
      this.busy = false;
    }
  }

  async fetch(scene) {
    const { islands, base } = scene;
    for (const { id, map } of islands) {
      if (this.islands.get(base + id)?.version === map) continue;
      const answer = await fetch(`${base}patches/${id}?v=${map}`);
      if (answer.status === 200) this.islands.set(base + id, { version: map, data: readPatches(await answer.arrayBuffer()) });
    }
    for (const key of this.islands.keys()) if (!islands.some(({ id }) => base + id === key)) this.islands.delete(key);
    if (this.next === scene) this.next = null;
  }
}
