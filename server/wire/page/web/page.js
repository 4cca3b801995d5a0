// The page: what the server tells goes into one world, and from there on the screen.

import { Images } from "./images.js";
import { extent, placeIslands } from "./layout.js";
import { Drawing } from "./drawing.js";
import { History } from "./history.js";
import { ask, askDrawn } from "./orders.js";
import { Overlay } from "./overlay.js";
import { showAnnotations, showClosures, showDownloads, showFigures, showLink, showRates, showRobots, showSightings, showWarnings } from "./panels.js";
import { Patches } from "./patches.js";
import { listen } from "./stream.js";
import { IslandTiles } from "./tiles.js";

const TOPICS = ["about", "islands", "robots", "trails", "tags", "annotations", "asked", "exploration", "closures", "sightings", "status",
  "meeting", "past"];
/** How long what is on the screen may stay while the next is loaded. */
const PREPARE_MS = 3000;
/** A click so near a robot is meant for it. */
const NEAR_PIXELS = 16;

const element = (id) => document.getElementById(id);

class Page {
  constructor(about) {
    this.begin(about);
    this.show = {};
    this.fits = true; // until somebody moves the map
    this.followed = null;
    this.images = new Images((path) => this.tiles.repaint(path));
    this.patches = new Patches(() => this.overlay.redraw(true));
    this.map = this.makeMap(about);
    this.tiles = new IslandTiles(this.images, this.scene, {
      tileSize: about.tile_cells, minNativeZoom: about.coarsest_zoom, maxNativeZoom: 0, minZoom: about.coarsest_zoom,
      maxZoom: 4, noWrap: true, keepBuffer: 1,
    }).addTo(this.map);
    this.history = new History(this, (past) => this.openPast(past), () => this.showView());
    this.overlay = new Overlay(this).addTo(this.map);
    this.drawn = null; // what is being asked about
    this.drawing = new Drawing(this, (drawn) => this.askDrawn(drawn));
    this.listenToUser();
  }

  /** Forgets what another run of the server told. */
  begin(about) {
    this.about = about;
    this.robots = [];
    this.trails = {};
    this.tags = [];
    this.annotations = [];
    this.asked = [];
    this.exploration = null; // nobody explores
    this.sightings = [];
    this.closures = [];
    this.meeting = null;
    this.marked = null; // a closure
    this.names = [];
    this.status = null;
    this.next = null;
    this.scene = { islands: [], offsets: new Map(), cell_m: about.cell_m, base: "" };
    if (!this.map) return;
    this.history.forget();
    this.images.clear();
    this.patches.clear();
    this.tiles.scene = this.scene;
  }

  /** What is looked at: the map as it is, or as it was. */
  get view() { return this.history?.map ?? this; }

  /** What is looked at is another. */
  showView() {
    const isOther = this.tiles.scene !== this.view.scene;
    this.tiles.scene = this.view.scene;
    this.tiles.repaint();
    if (isOther && this.fits) this.fit();
    this.updatePatches();
    this.overlay.redraw(true);
  }

  /** A map as it was, as the server tells of it, with a scene to be drawn. */
  async openPast(past) {
    const base = `past/${past.snapshot}/`;
    const islands = await Promise.all(past.islands.map((island) => this.withVersions(island, base)));
    return { ...past, scene: this.sceneOf(islands, base) };
  }

  /** `base`: before the paths of what belongs to its islands. */
  sceneOf(islands, base) {
    const { cell_m } = this.about;
    return { islands, offsets: placeIslands(islands, 64 * cell_m), cell_m, base };
  }

  makeMap(about) {
    const perMetre = 1 / about.cell_m;
    const map = L.map("map", {
      crs: L.extend({}, L.CRS.Simple, { transformation: new L.Transformation(perMetre, 0, -perMetre, 0) }),
      attributionControl: false, zoomAnimation: false, fadeAnimation: false, inertia: false,
    });
    L.control.scale({ imperial: false, maxWidth: 160 }).addTo(map);
    map.setView([0, 0], -1);
    return map;
  }

  listenToUser() {
    const byHand = () => {
      this.fits = false;
      this.follow(null);
    };
    this.map.on("dragstart", byHand);
    this.map.on("resize", () => { if (this.fits) this.fit(); });
    this.map.on("click", (event) => { if (!this.drawing.tookPress) this.followAt(event.containerPoint); });
    for (const kind of ["place", "keep_out", "speed"]) element(`draw-${kind}`).onclick = () => this.drawing.begin(kind);
    for (const event of ["wheel", "dblclick"]) this.map.getContainer().addEventListener(event, () => { this.fits = false; });
    this.map.zoomControl.getContainer().addEventListener("click", () => { this.fits = false; });
    element("fit").onclick = () => {
      this.fits = true;
      this.follow(null);
      this.fit();
    };
    element("refine").onclick = () => this.order({ verb: "refine" });
    for (const name of ["patches", "relations", "trails", "sightings", "tags", "annotations", "asked", "exploration", "closures"]) {
      const box = element(`show-${name}`);
      const take = () => {
        this.show[name] = box.checked;
        this.updatePatches();
        this.overlay.redraw(true);
      };
      box.onchange = take;
      take();
    }
  }

  order(order) {
    ask(order, this.about, this.status);
  }

  askDrawn(drawn) {
    this.drawn = drawn;
    this.overlay.redraw();
    askDrawn(drawn, this.about, () => {
      this.drawn = null;
      this.overlay.redraw();
    });
  }

  /** What can be done with a place or zone of the list. */
  annotationActs() {
    return {
      show: ({ island, points }) => {
        const offset = this.scene.offsets.get(island);
        if (!offset || points.length === 0) return;
        this.fits = false;
        const bounds = points.map(([x, y]) => [y + offset[1], x + offset[0]]);
        this.map.fitBounds(bounds, { animate: false, padding: [120, 120], maxZoom: 1 });
      },
      edit: ({ kind, name, island, points, max_speed }) => {
        const corners = kind === "place" ? [] : points.map(([x, y]) => [x, y]);
        this.drawing.begin(kind, { name, replace: true, max_speed, ...(corners.length > 0 ? { island, points: corners } : {}) });
      },
      erase: ({ name }) => this.order({ verb: "erase", name }),
    };
  }

  /** Brings a closure into view, where it is on the map, and marks it. */
  showClosure({ id, line: [island, x0, y0, x1, y1] }) {
    const [east, north] = this.scene.offsets.get(island) ?? [NaN, NaN];
    if (Number.isNaN(east)) return;
    this.fits = false;
    this.marked = id;
    this.map.fitBounds([[y0 + north, x0 + east], [y1 + north, x1 + east]], { animate: false, padding: [160, 160], maxZoom: 1 });
    this.overlay.redraw(true);
  }

  follow(name) {
    this.followed = this.followed === name ? null : name;
    if (this.followed) this.fits = false;
    this.showLists();
    this.keepInView();
  }

  /** Follows the robot at a point of the screen, if there is one. */
  followAt(point) {
    const at = this.history.robots().map((robot) => [robot.name, this.placeOf(robot)]).filter(([, place]) => place);
    const distances = at.map(([name, place]) => [this.map.latLngToContainerPoint(place).distanceTo(point), name]);
    const [distance, name] = distances.sort(([a], [b]) => a - b)[0] ?? [Infinity];
    if (distance < NEAR_PIXELS) this.follow(name);
  }

  /** Where a robot is on the screen's plane; null where its island is not shown. */
  placeOf(robot) {
    const offset = this.view.scene.offsets.get(robot.at[0]);
    return offset ? [robot.at[2] + offset[1], robot.at[1] + offset[0]] : null;
  }

  keepInView() {
    const robot = this.history.robots().find(({ name }) => name === this.followed);
    const place = robot && this.placeOf(robot);
    if (place) this.map.panTo(place, { animate: false });
    this.overlay.redraw();
  }

  fit() {
    const { scene } = this.view;
    const box = extent(scene.islands, scene.offsets);
    if (!box) return;
    this.map.fitBounds([[box[1], box[0]], [box[3], box[2]]], { animate: false, padding: [30, 48], maxZoom: 1 });
  }

  showLists() {
    if (!this.status) return;
    showFigures(this.status, this.scene.islands);
    showWarnings(this.status);
    showDownloads(this.scene.islands);
    showRobots(this, (name) => this.follow(name), (order) => this.order(order));
  }

  updatePatches() {
    if (this.show.patches || this.show.relations || this.history.until !== null) this.patches.update(this.view.scene);
  }

  /** Shows other islands, once what is needed of them is there; of those that come meanwhile only the newest. */
  async take(islands) {
    const isBusy = this.next !== null;
    this.next = islands;
    if (isBusy) return;
    const about = this.about;
    while (this.about === about && this.next) {
      const list = this.next;
      try {
        await this.change(list, about);
      } catch {
        // The server is away; it tells of its islands when it is back.
      }
      if (this.about === about && this.next === list) this.next = null;
    }
  }

  async change(list, about) {
    const islands = await Promise.all(list.map((island) => this.withVersions(island, "")));
    const scene = this.sceneOf(islands, "");
    const shownBefore = extent(this.scene.islands, this.scene.offsets);
    await Promise.race([this.tiles.prepare(scene), new Promise((resolve) => { setTimeout(resolve, PREPARE_MS); })]);
    if (this.about !== about) return;
    this.scene = scene;
    this.tiles.scene = this.view.scene;
    this.tiles.repaint();
    if (this.fits && String(shownBefore) !== String(extent(islands, scene.offsets))) this.fit();
    this.history.update();
    this.updatePatches();
    this.overlay.redraw(true);
    this.showLists();
  }

  /** An island with the versions of all its tiles, of which only those that changed are asked for. */
  async withVersions(island, base) {
    const before = base === "" ? this.scene.islands.find(({ id }) => id === island.id) : undefined;
    if (before?.tiles === island.tiles) return { ...island, versions: before.versions };
    const answer = await fetch(`${base}tiles/${island.id}?since=${before?.tiles ?? 0}`);
    const versions = new Map(before?.versions);
    for (const [zoom, x, y, version] of answer.ok ? await answer.json() : []) versions.set(`${zoom}/${x}/${y}`, version);
    return { ...island, versions };
  }
}

let page = null;

/** Handlers of the topics; `about` comes first. */
const handlers = {
  about(about) {
    if (!page) page = new Page(about);
    else if (page.about.run !== about.run) page.begin(about);
    window.isthmus = page; // for those who look from outside: tests, and the browser's console
  },
  islands: (islands) => page.take(islands),
  robots(robots) {
    page.robots = robots;
    if (page.followed) page.keepInView();
    page.overlay.redraw();
  },
  trails(trails) {
    page.trails = trails;
    page.overlay.redraw(true);
  },
  tags: (tags) => { page.tags = tags; },
  annotations(annotations) {
    page.annotations = annotations;
    showAnnotations(annotations, page.annotationActs());
    page.overlay.redraw(true);
  },
  asked(asked) {
    page.asked = asked;
    page.overlay.redraw(true);
  },
  exploration(exploration) {
    page.exploration = exploration;
    element("with-exploration").hidden = exploration === null;
    page.overlay.redraw(true);
  },
  past: () => page.history.list(),
  meeting: (meeting) => { page.meeting = meeting; },
  closures(closures) {
    page.closures = closures;
    showClosures(closures, (order) => page.order(order), (closure) => page.showClosure(closure));
    page.overlay.redraw(true);
  },
  sightings(sightings) {
    page.sightings = sightings;
    showSightings(sightings);
    page.overlay.redraw();
  },
  status(status) {
    page.status = status;
    page.names = status.colours;
    page.showLists();
    showRates(status);
  },
};

listen(TOPICS, handlers, showLink);
