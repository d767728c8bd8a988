/** The page of `pingvox view`: reads what the program serves and puts the parts together. */
import { Box3, Quaternion, Vector3 } from "three";
import { Answers } from "./answers";
import type { View } from "./camera";
import { Clock } from "./clock";
import { scaleTexture } from "./colours";
import { DisplayPanel, filterOf, type LayerSwitch } from "./display_panel";
import { bytesText, Choice, element, fixed, isFramedByAnotherHost, styleColour } from "./dom";
import { type ColourBy, faceMaterial, plainMaterial, setCanvasHeight, setColouring, setSlab } from "./face_material";
import { FaceService, startWorker } from "./face_service";
import type { ClassOf } from "./faces";
import { serveFaces } from "./faces_worker";
import { addKeys } from "./keys";
import { drawScale, showLegend } from "./legend";
import { mergeCells } from "./live_cells";
import { LiveConnection, type LiveState } from "./live_connection";
import { LiveLog } from "./live_log";
import { LivePanel } from "./live_panel";
import { MapLayer } from "./map_layer";
import { MapSigns } from "./map_signs";
import { joinPaths, mountedPose, pointOf, type Pose, poseAt } from "./path";
import { pointCloud } from "./point_cloud";
import { Ruler } from "./ruler";
import { type PathColumns, readCells, readLog, readPath, readPoints, type Scene } from "./scene";
import { SonarLog } from "./sonar_log";
import { SonarPanel } from "./sonar_panel";
import { TimeLine } from "./time_line";
import { Vehicle } from "./vehicle";
import { View3D } from "./view3d";
import { WideLines } from "./wide_lines";

/** Of all cells, those that lie beyond these parts do not stretch the scale of heights. */
const scaleParts = { low: 0.005, high: 0.995 };
const classesOf: Record<ColourBy, ClassOf> = { height: "none", probability: "probability", agreement: "agreement" };
const sliceMargin = 1e-3;
const clickPixels = 5;
/** Of a path's line; the vehicle's pose is between those of the path itself. */
const mostLinePoints = 20000;
/** Of a path that grows, whose line is made again and again. */
const mostLivePoints = 4000;
/** The whole is shown again when it has grown by so much. */
const growth = 1.05;

const grouped = new Intl.NumberFormat("en");

class Page {
  private readonly answers = new Answers();
  private readonly view = new View3D(element<HTMLCanvasElement>("map"));
  private readonly service: FaceService;
  private readonly scale = scaleTexture();
  private readonly material = faceMaterial(this.scale);
  private readonly spaceMaterials = {
    free: plainMaterial(this.scale, "#6db4d8", 0.16),
    unknown: plainMaterial(this.scale, "#8a8f96", 1),
  };
  private readonly ruler = new Ruler(this.view);
  private readonly vehicle = new Vehicle();
  private readonly lines: WideLines[] = [this.ruler.line];
  private readonly paths = new Map<number, PathColumns>();
  private readonly pathLines: WideLines[] = [];
  private readonly switches: LayerSwitch[] = [];
  private clock: Clock | null = null;
  /** What the vehicle's beam was made for. */
  private placed: { now: number; log: SonarLog | null } = { now: NaN, log: null };
  private sonar: SonarPanel | null = null;
  private panel: DisplayPanel | null = null;
  private heights = { from: 0, to: 1 };
  private lowestProbability = 0.4;
  private colouredBy: ColourBy = "height";
  private live: LivePanel | null = null;
  private liveRun = -1;
  private timeLine: TimeLine | null = null;
  private fitted = 0;
  private counted = "";
  private pointerText = "";
  private rulerText = "";

  constructor(
    script: HTMLScriptElement,
    private scene: Scene | null = null,
  ) {
    this.service = new FaceService(startWorker(script));
    this.view.world.add(this.vehicle.group);
  }

  async start(): Promise<void> {
    this.useStyle();
    matchMedia("(prefers-color-scheme: light)").addEventListener("change", () => this.useStyle());
    const scene = (this.scene = await this.answers.json<Scene>("scene.json"));
    document.title = `${scene.title} – pingvox`;
    element("title").textContent = scene.title;
    element("title").title = scene.title;
    this.showNotes(scene.notes ?? []);
    for (const entry of scene.maps) await this.addMap(scene, entry);
    for (const entry of scene.paths) this.addPath(entry.id, entry.name, readPath(await this.answers.bytes(entry.url)));
    for (const entry of scene.points) {
      const cloud = pointCloud(readPoints(await this.answers.bytes(entry.url)));
      this.view.world.add(cloud);
      this.addSwitch(entry.name, (visible) => (cloud.visible = visible));
      this.box.union(new Box3().setFromObject(cloud));
    }
    this.frameScene();
    const signs = new MapSigns(this.view.orbit, scene.axes);
    const panel = this.connectDisplay();
    this.connectMap(signs);
    this.colour("height");
    await this.addLogs(scene);
    const colours = this.connectColours(scene);
    const views = new Choice<View>(element("views"), "view", (view) => this.view.orbit.showAll(view));
    this.view.orbit.onView = (view) => (views.value = view);
    this.connectButtons(panel);
    addKeys({
      view: (view) => views.choose(view),
      showAll: () => this.view.orbit.showAll(),
      arrowUp: () => signs.arrowUp(),
      nextColour: () =>
        colours.choose(colours.values[(colours.values.indexOf(colours.value) + 1) % colours.values.length]),
      measure: () => element("measure").click(),
      endMeasure: () => this.measure(false),
      display: () => panel.toggle(),
      sonar: () => element("sonar-toggle").click(),
      play: () => element("play").click(),
      step: (direction) => this.sonar?.step(direction),
      stepTurn: (direction) => this.sonar?.stepTurn(direction),
      help: () => element("help").click(),
    });
    if (scene.live) this.follow(scene.live);
    document.documentElement.dataset.page = "ready";
  }

  /** Shows what is new of a run that goes on. */
  private follow(live: NonNullable<Scene["live"]>): void {
    this.live = new LivePanel(isFramedByAnotherHost(window) ? null : live.control);
    const connection = new LiveConnection(live, (state) => this.update(live, state));
    connection.onConnection = (state) => this.live!.setConnection(state);
    connection.start();
  }

  private async update(live: NonNullable<Scene["live"]>, state: LiveState): Promise<void> {
    if (this.liveRun >= 0 && state.run !== this.liveRun) {
      // Another run at the same address.
      location.reload();
      return;
    }
    this.liveRun = state.run;
    this.live!.show(state.status);
    await this.updateMap(live.changes, state.map.version);
    await this.updatePath(state.path);
    await this.updateLog(state);
    document.documentElement.dataset.version = String(state.map.version);
    this.view.requestFrame();
  }

  private async updateMap(url: string, version: number): Promise<void> {
    const layer = this.view.layers[0];
    const known = readCells(layer.cells).version;
    if (known === version) return;
    const bytes = await this.answers.bytes(`${url}?since=${known}`);
    const changes = readCells(bytes);
    const cells = mergeCells(layer.cells, bytes);
    const extent = await this.service.ask({ kind: "map", map: layer.entry.id, cells, agreement: null });
    layer.entry.occupied_cells = readCells(cells).probability.length;
    layer.replaceCells(extent, cells, changes.isPart ? changes : null);
    layer.renewSpaces(() => this.answers.bytes(layer.entry.free!));
    this.panel?.update(this.view.layers);
    this.showWhole();
    const heights = this.heightRange();
    if (heights.from !== this.heights.from || heights.to !== this.heights.to) {
      this.heights = heights;
      this.colour(this.colouredBy);
    }
    element("progress").hidden = layer.entry.occupied_cells > 0;
  }

  private async updatePath(state: LiveState["path"]): Promise<void> {
    const entry = this.scene!.paths[0];
    if (!entry) return;
    const known = this.paths.get(entry.id)!;
    if (known.version === state.version && known.time.length === state.poses) return;
    const fresh = readPath(
      await this.answers.bytes(`${entry.url}?version=${known.version}&from=${known.time.length}`),
    );
    const path = fresh.first > 0 ? joinPaths(known, fresh) : fresh;
    this.paths.set(entry.id, path);
    this.drawPath(this.pathLines[0], path, mostLivePoints);
    this.placed.now = NaN;
    this.showWhole();
  }

  private async updateLog({ log: state }: LiveState): Promise<void> {
    const log = this.sonar?.log;
    if (!(log instanceof LiveLog) || !this.clock) return;
    await log.update(state);
    const { time } = log.columns;
    if (time.length === 0) return;
    this.placed.now = NaN;
    this.clock.setRange(time[0], time[time.length - 1]);
    this.timeLine?.drawTurns();
    this.sonar!.requestDraw();
  }

  /** The camera keeps showing the whole growing map until the user moves it. */
  private showWhole(): void {
    this.box.makeEmpty();
    for (const layer of this.view.layers) this.box.union(layer.bounds);
    for (const path of this.paths.values()) {
      for (let i = 0; i < path.time.length; i += Math.max(1, path.time.length >> 8)) {
        this.box.expandByPoint(pointOf(path, i));
      }
    }
    if (this.box.isEmpty()) return;
    this.view.orbit.setScene(this.box);
    const size = this.box.min.distanceTo(this.box.max);
    if (this.view.orbit.isMoved || (size < growth * this.fitted && growth * size > this.fitted)) return;
    this.fitted = size;
    this.view.orbit.showAll(this.view.orbit.view, "jump");
  }

  private readonly box = new Box3();

  /** Colours that the canvases take from the style sheet. */
  private useStyle(): void {
    this.view.setBackground(styleColour("--ground"));
    const accent = styleColour("--accent");
    const ink = styleColour("--ink");
    for (const line of this.lines) line.setColour(accent);
    this.ruler.line.setColour(ink);
    this.vehicle.setColours(accent, ink);
    this.sonar?.requestDraw();
  }

  private showNotes(notes: readonly string[]): void {
    if (notes.length === 0) return;
    const details = element<HTMLDetailsElement>("notes");
    details.hidden = false;
    details.querySelector("summary")!.textContent = notes.length === 1 ? "1 note" : `${notes.length} notes`;
    details.querySelector("ul")!.replaceChildren(
      ...notes.map((note) => {
        const item = document.createElement("li");
        item.textContent = note;
        return item;
      }),
    );
  }

  private addSwitch(name: string, setVisible: (visible: boolean) => void): void {
    this.switches.push({
      name,
      setVisible: (visible) => {
        setVisible(visible);
        this.view.requestFrame();
      },
    });
  }

  private async addMap(scene: Scene, entry: Scene["maps"][number]): Promise<void> {
    const [cells, agreement] = await Promise.all([
      this.answers.bytes(entry.cells),
      entry.agreement ? this.answers.bytes(entry.agreement) : null,
    ]);
    // Single precision does not have 0.4.
    this.lowestProbability = Math.round(readCells(cells).lowestProbability * 1000) / 1000;
    const extent = await this.service.ask({ kind: "map", map: entry.id, cells, agreement });
    const layer = new MapLayer(
      entry,
      extent,
      cells,
      agreement,
      scene.origin_m,
      this.service,
      this.material,
      this.spaceMaterials,
    );
    layer.filter = { ...layer.filter, threshold: Math.round(entry.occupancy * 255) };
    layer.onError = (error) => showError(error);
    this.view.addLayer(layer);
    this.addSwitch(entry.name, (visible) => (layer.group.visible = visible));
    this.box.union(layer.bounds);
  }

  private addPath(id: number, name: string, path: PathColumns): void {
    this.paths.set(id, path);
    const line = new WideLines(3);
    this.drawPath(line, path, mostLinePoints);
    this.view.world.add(line);
    this.lines.push(line);
    this.pathLines.push(line);
    this.addSwitch(name, (visible) => (line.visible = visible));
    for (let i = 0; i < path.time.length; ++i) this.box.expandByPoint(pointOf(path, i));
    this.useStyle();
  }

  private drawPath(line: WideLines, path: PathColumns, most: number): void {
    const points: Vector3[] = [];
    const times: number[] = [];
    const start = path.time[0] ?? 0;
    const each = Math.max(1, Math.ceil(path.time.length / most));
    for (let i = 0; i < path.time.length; i += each) {
      points.push(pointOf(path, i));
      // Since the start, which single precision can resolve.
      times.push(path.time[i] - start);
    }
    line.setLine(points, times);
    line.userData.start = start;
  }

  private frameScene(): void {
    if (this.box.isEmpty()) this.box.set(new Vector3(-1, -1, -1), new Vector3(1, 1, 1));
    this.view.orbit.setScene(this.box);
    this.view.orbit.showAll("free", "jump");
    this.heights = this.heightRange();
  }

  /** Absolute heights between which nearly all cells are. */
  private heightRange(): { from: number; to: number } {
    let [from, to] = [Infinity, -Infinity];
    for (const { extent, entry } of this.view.layers) {
      const total = extent.layers.reduce((sum, count) => sum + count, 0);
      if (total === 0) continue;
      let below = 0;
      for (let i = 0; i < extent.layers.length; ++i) {
        const z = (extent.lowestLayer + i) * entry.resolution_m;
        if (below <= scaleParts.low * total && below + extent.layers[i] > scaleParts.low * total)
          from = Math.min(from, z);
        below += extent.layers[i];
        if (below >= scaleParts.high * total) {
          to = Math.max(to, z + entry.resolution_m);
          break;
        }
      }
    }
    return to > from ? { from, to } : { from: 0, to: 1 };
  }

  private connectDisplay(): DisplayPanel {
    const panel = new DisplayPanel(this.view.layers, this.lowestProbability, this.switches);
    this.panel = panel;
    panel.onSelection = () => {
      for (const layer of this.view.layers) {
        layer.filter = filterOf(panel.selection, layer.entry.resolution_m);
        layer.finest = panel.selection.level;
        this.remake(layer);
      }
      // What is drawn is cut at once; the faces of the cut come when they are made.
      const origin = this.scene!.origin_m[2];
      setSlab(this.material, panel.selection.low - origin - sliceMargin, panel.selection.high - origin + sliceMargin);
    };
    panel.onSpace = (space, shown) => {
      document.documentElement.dataset.detail = "partial";
      for (const layer of this.view.layers) {
        if (!layer.entry.free) continue;
        layer.showSpace(space, shown, () => this.answers.bytes(layer.entry.free!));
      }
    };
    return panel;
  }

  private connectMap(signs: MapSigns): void {
    const canvas = element<HTMLCanvasElement>("map");
    this.view.onFrame.push(() => {
      for (const line of this.lines) line.setViewport(canvas.clientWidth, canvas.clientHeight);
      for (const material of [this.material, ...Object.values(this.spaceMaterials)])
        setCanvasHeight(material, canvas.height);
      this.vehicle.setViewport(canvas.clientWidth, canvas.clientHeight);
      signs.update();
      this.ruler.update();
      this.placeVehicle();
      this.showState();
    });
    let down = { x: 0, y: 0 };
    const place = (event: PointerEvent | MouseEvent): [number, number] => {
      const box = canvas.getBoundingClientRect();
      return [((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2];
    };
    canvas.addEventListener("pointerdown", (event) => (down = { x: event.clientX, y: event.clientY }));
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons === 0) this.showPointer(...place(event));
    });
    canvas.addEventListener("pointerleave", () => this.setPointerText(""));
    canvas.addEventListener("pointerup", (event) => {
      if (Math.hypot(event.clientX - down.x, event.clientY - down.y) > clickPixels || event.button !== 0) return;
      const hit = this.view.pick(...place(event));
      this.showPointer(...place(event));
      if (this.ruler.isActive && hit) this.ruler.add(hit.point);
    });
    canvas.addEventListener("dblclick", (event) => {
      const hit = this.view.pick(...place(event));
      if (hit && !this.ruler.isActive) this.view.orbit.lookAt(hit.point);
    });
    this.ruler.onText = (text) => {
      this.rulerText = text;
      this.showReadout();
    };
  }

  private showPointer(x: number, y: number): void {
    const hit = this.view.pick(x, y);
    if (!hit) {
      this.setPointerText("");
      return;
    }
    const { axes, origin_m } = this.scene!;
    const [px, py, pz] = hit.point.toArray().map((c, axis) => fixed(c + origin_m[axis], 2));
    const { probability, agreement } = hit.layer.valuesOf(hit);
    const up = axes.x === "x" ? "z" : "up";
    const agreed =
      agreement === null
        ? ""
        : agreement === 0
          ? " · not judged"
          : ` · agreement ${Math.round((agreement / 255) * 100)} %`;
    this.setPointerText(`${axes.x} ${px} · ${axes.y} ${py} · ${up} ${pz} m · p ${fixed(probability, 2)}${agreed}`);
  }

  private setPointerText(text: string): void {
    this.pointerText = text;
    this.showReadout();
  }

  private showReadout(): void {
    element("readout").textContent = this.rulerText || this.pointerText;
  }

  private connectColours(scene: Scene): Choice<ColourBy> {
    const colours = new Choice<ColourBy>(element("colours"), "colour", (by) => this.colour(by));
    colours.show(
      "agreement",
      scene.maps.some((entry) => entry.agreement),
    );
    element("colours").hidden = scene.maps.length === 0;
    element("legend").hidden = scene.maps.length === 0;
    return colours;
  }

  private colour(by: ColourBy): void {
    this.colouredBy = by;
    const { from, to } = this.heights;
    const origin = this.scene!.origin_m[2];
    const shown = {
      height: { title: "Height, m", from, to, shift: origin },
      probability: { title: "Probability", from: this.lowestProbability, to: 1, shift: 0 },
      agreement: { title: "Agreement", from: 0, to: 1, shift: 0 },
    }[by];
    drawScale();
    showLegend(shown.title, shown.from, shown.to, by === "agreement" ? "grey: not judged" : "");
    setColouring(this.material, by, shown.from - shown.shift, shown.to - shown.shift);
    for (const layer of this.view.layers) {
      // Without agreements a map has one colour then.
      const classes = by === "agreement" && !layer.entry.agreement ? "none" : classesOf[by];
      if (layer.classOf === classes) continue;
      layer.classOf = classes;
      this.remake(layer);
    }
    this.view.requestFrame();
  }

  private remake(layer: MapLayer): void {
    document.documentElement.dataset.detail = "partial";
    layer.remake();
  }

  private async addLogs(scene: Scene): Promise<void> {
    const logs: SonarLog[] = [];
    for (const entry of scene.logs) {
      const log = scene.live
        ? new LiveLog(entry, this.answers)
        : new SonarLog(entry, readLog(await this.answers.bytes(entry.url)), this.answers);
      log.onError = showError;
      if (log.columns.beams > 0 || scene.live) logs.push(log);
    }
    const spans = [
      ...(logs.length > 0 ? logs.map((log) => log.columns.time) : [...this.paths.values()].map((path) => path.time)),
    ];
    const timed = spans.filter((times) => times.length > 0);
    if (timed.length === 0 && logs.length === 0) return;
    const clock = new Clock(
      Math.min(...timed.map((times) => times[0])),
      Math.max(...timed.map((times) => times[times.length - 1])),
    );
    if (timed.length === 0) clock.from = clock.to = 0;
    this.clock = clock;
    if (logs.length > 0) {
      element("sonar").hidden = false;
      element("sonar-toggle").hidden = false;
      this.sonar = new SonarPanel(logs, clock);
      // The map has less space now.
      this.view.resize();
      this.view.orbit.showAll("free", "jump");
    }
    const timeLine = new TimeLine(clock, this.sonar);
    this.timeLine = timeLine;
    if (scene.live) this.showNewest(clock);
    if (this.sonar) {
      this.sonar.onChange = () => {
        timeLine.drawTurns();
        this.view.requestFrame();
      };
      if (!scene.live) clock.now = logs[0].columns.time[firstTelling(logs[0])];
      this.sonar.draw();
    }
    clock.onChange(() => this.view.requestFrame());
    this.view.requestFrame();
  }

  /** A button goes back from an earlier time to what comes in. */
  private showNewest(clock: Clock): void {
    const button = element("newest");
    button.hidden = false;
    button.addEventListener("click", () => {
      clock.pause();
      clock.now = clock.to;
    });
    clock.onChange(() => button.setAttribute("aria-pressed", String(clock.isFollowing)));
  }

  private placeVehicle(): void {
    if (!this.clock) return;
    const { now } = this.clock;
    for (const line of this.pathLines) line.setNow(now - line.userData.start);
    const log = this.sonar?.log ?? null;
    const pose = this.vehicleAt(now);
    this.vehicle.setPose(pose, this.view.orbit.metresPerPixel);
    // The beam is rebuilt with another time only.
    if (this.placed.now === now && this.placed.log === log) return;
    this.placed = { now, log };
    if (!pose || !log || log.columns.beams === 0) {
      this.vehicle.setBeam(null);
      return;
    }
    const beam = log.beamAt(now);
    const radians = Math.PI / 180;
    this.vehicle.setBeam({
      sonar: mountedPose(pose, log.entry.mount),
      bearing: log.columns.bearing[beam],
      width: log.entry.beam_width_deg * radians,
      height: log.entry.beam_height_deg * radians,
      range: log.rangeOf(beam),
      echo: log.columns.echo[beam],
    });
  }

  /** A log without a path is that of a head which stands still at the origin, as the program maps it. */
  private vehicleAt(time: number): Pose | null {
    const log = this.sonar?.log;
    if (!log) return poseAt([...this.paths.values()][0], time);
    if (log.entry.path !== null) {
      // Live, the newest pose may be older or newer than the newest beam.
      const isNewest = this.live !== null && this.clock!.isFollowing;
      return poseAt(this.paths.get(log.entry.path)!, isNewest ? Infinity : time);
    }
    const [x, y, z] = this.scene!.origin_m;
    return { position: new Vector3(-x, -y, -z), attitude: new Quaternion() };
  }

  private showState(): void {
    const faces = this.view.layers.reduce((sum, layer) => sum + layer.facesDrawn, 0);
    const cells = this.view.layers.reduce((sum, layer) => sum + layer.cellsDrawn, 0);
    const counted = [faces, cells, this.answers.received].join();
    if (counted !== this.counted) {
      this.counted = counted;
      element("faces-drawn").textContent = grouped.format(faces);
      element("cells-drawn").textContent = grouped.format(cells);
      const perFace = faces > 0 ? `, ${(this.answers.received / faces).toFixed(1)} a face` : "";
      element("bytes-received").textContent = bytesText(this.answers.received) + perFace;
    }
    const { dataset } = document.documentElement;
    const isComplete = this.view.isComplete && !this.panel?.isPending;
    dataset.detail = isComplete ? "complete" : "partial";
    if (isComplete) setSlab(this.material, -1e9, 1e9);
    if (dataset.map === "shown" || !this.view.layers.every((layer) => layer.isShown)) return;
    dataset.map = "shown";
    element("progress").hidden = true;
    element("first-picture").textContent = `${(performance.now() / 1000).toFixed(2)} s`;
    if (this.view.layers.length > 0 && this.view.layers.every((layer) => layer.entry.occupied_cells === 0)) {
      element("progress").hidden = false;
      element("progress").textContent = this.scene?.live
        ? "Nothing is mapped yet (SLAM needs two turns of the head)"
        : "The map has no occupied cells";
    }
  }

  private measure(active: boolean): void {
    this.ruler.setActive(active);
    element("measure").setAttribute("aria-pressed", String(active));
  }

  /** On a phone the colours are among what is seldom used, so that the bar is not longer than the screen. */
  private placeColours(): void {
    const narrow = matchMedia("(max-width: 700px)");
    const [colours, panel, measure] = [element("colours"), element("display-panel"), element("measure")];
    const place = () => (narrow.matches ? panel.prepend(colours) : measure.before(colours));
    narrow.addEventListener("change", place);
    place();
  }

  private connectButtons(panel: DisplayPanel): void {
    this.placeColours();
    element("measure").addEventListener("click", () => this.measure(!this.ruler.isActive));
    element("display").addEventListener("click", () => panel.toggle());
    const sonar = element("sonar-toggle");
    sonar.addEventListener("click", () => {
      element("sonar").hidden = !element("sonar").hidden;
      sonar.setAttribute("aria-pressed", String(!element("sonar").hidden));
    });
    const help = element<HTMLDialogElement>("help-dialog");
    element("help").addEventListener("click", () => (help.open ? help.close() : help.showModal()));
  }
}

/** The last beam of the first turn that has nearly as many echoes as any: what the page shows at first. */
function firstTelling({ columns: { sweep, echo } }: SonarLog): number {
  const turns: { last: number; echoes: number }[] = [];
  for (let i = 0; i < sweep.length; ++i) {
    if (i === 0 || sweep[i] !== sweep[i - 1]) turns.push({ last: i, echoes: 0 });
    const turn = turns[turns.length - 1];
    turn.last = i;
    if (Number.isFinite(echo[i])) ++turn.echoes;
  }
  const most = turns.reduce((echoes, turn) => Math.max(echoes, turn.echoes), 0);
  return turns.find((turn) => turn.echoes >= 0.9 * most)?.last ?? 0;
}

function showError(error: unknown): void {
  element("progress").hidden = true;
  const text = element("error");
  text.hidden = false;
  text.textContent = error instanceof Error ? error.message : String(error);
}

if (typeof document === "undefined") {
  serveFaces(globalThis as unknown as Parameters<typeof serveFaces>[0]);
} else {
  try {
    new Page(document.currentScript as HTMLScriptElement).start().catch(showError);
  } catch (error) {
    showError(error);
  }
}
