// Scenes in the bytes that the program serves: what the tests of the page read.

/** Random numbers that are the same each time. */
export function randomNumbers(seed) {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** Bytes of an answer: 32-bit words of a header and then columns, padded to 4. */
function answer(header, columns) {
  const length = 4 * header.length + columns.reduce((sum, column) => sum + column.byteLength, 0);
  const bytes = new Uint8Array(Math.ceil(length / 4) * 4);
  const view = new DataView(bytes.buffer);
  header.forEach((word, i) =>
    word instanceof Float32Array ? view.setFloat32(4 * i, word[0], true) : view.setUint32(4 * i, word, true),
  );
  let at = 4 * header.length;
  for (const column of columns) {
    bytes.set(new Uint8Array(column.buffer, column.byteOffset, column.byteLength), at);
    at += column.byteLength;
  }
  return bytes;
}

/** Cells by brick: `set(x, y, z, probability 0 to 255)`. */
export class CellSet {
  bricks = new Map();
  count = 0;

  set(x, y, z, probability) {
    const key = `${x >> 2},${y >> 2},${z >> 2}`;
    let brick = this.bricks.get(key);
    if (!brick) this.bricks.set(key, (brick = { at: [x >> 2, y >> 2, z >> 2], cells: new Uint8Array(64) }));
    const bit = (x & 3) | ((y & 3) << 2) | ((z & 3) << 4);
    if (brick.cells[bit] === 0) ++this.count;
    brick.cells[bit] = probability;
  }

  has(x, y, z) {
    const brick = this.bricks.get(`${x >> 2},${y >> 2},${z >> 2}`);
    return brick !== undefined && brick.cells[(x & 3) | ((y & 3) << 2) | ((z & 3) << 4)] > 0;
  }

  /** Bytes of `map/N/cells`. */
  bytes(resolution) {
    const bricks = [...this.bricks.values()];
    const columns = [0, 1, 2].map((axis) => Int32Array.from(bricks, (brick) => brick.at[axis]));
    const low = new Uint32Array(bricks.length);
    const high = new Uint32Array(bricks.length);
    const probability = new Uint8Array(this.count);
    let next = 0;
    bricks.forEach((brick, b) => {
      for (let bit = 0; bit < 64; ++bit) {
        if (brick.cells[bit] === 0) continue;
        if (bit < 32) low[b] |= 1 << bit;
        else high[b] |= 1 << (bit - 32);
        probability[next++] = brick.cells[bit];
      }
    });
    const header = [0x43585650, bricks.length, this.count, 1, Float32Array.of(0.4), Float32Array.of(resolution), 0, 0];
    return answer(header, [...columns, low, high, probability]);
  }
}

function freeBytes(cubes) {
  const columns = [0, 1, 2].map((axis) => Int32Array.from(cubes, (cube) => cube[axis]));
  return answer([0x46585650, cubes.length, 0, 0], [...columns, Uint32Array.from(cubes, (cube) => cube[3])]);
}

function pathBytes(poses) {
  const column = (name) => Float32Array.from(poses, (pose) => pose[name]);
  return answer(
    [0x50585650, poses.length, 0, 0],
    [Float64Array.from(poses, (pose) => pose.time), ...["x", "y", "z", "qx", "qy", "qz", "qw"].map(column)],
  );
}

const tank = { length: 8, width: 5, depth: 3, resolution: 0.05 };
const floater = { x: 5.5, y: 3.6, z: -0.8, radius: 0.45 };
export const origin = [300000, 5900000, 0];
export const beamsPerTurn = 400;
export const turns = 4;
export const bins = 400;
export const startTime = 1700000000;
export const beamSeconds = 0.05;

/** Where the vehicle is: a slow oval through the tank, ahead along its way. */
function vehicleAt(part) {
  const angle = 2 * Math.PI * part;
  const heading = angle + Math.PI / 2;
  return {
    x: 4 + 2 * Math.cos(angle),
    y: 2.4 + 1 * Math.sin(angle),
    z: -1.5 + 0.3 * Math.sin(2 * angle),
    qx: 0,
    qy: 0,
    qz: Math.sin(heading / 2),
    qw: Math.cos(heading / 2),
    heading,
  };
}

function rangeTo(x, y, direction) {
  const [dx, dy] = [Math.cos(direction), Math.sin(direction)];
  const walls = [
    dx > 0 ? (tank.length - x) / dx : dx < 0 ? -x / dx : Infinity,
    dy > 0 ? (tank.width - y) / dy : dy < 0 ? -y / dy : Infinity,
  ];
  const [fx, fy] = [floater.x - x, floater.y - y];
  const along = fx * dx + fy * dy;
  const across2 = fx * fx + fy * fy - along * along;
  const toFloater =
    along > 0 && across2 < floater.radius ** 2 ? along - Math.sqrt(floater.radius ** 2 - across2) : Infinity;
  return Math.min(...walls, toFloater);
}

function logAnswers() {
  const random = randomNumbers(5);
  const beams = turns * beamsPerTurn;
  const binLength = 10 / bins;
  const columns = {
    time: new Float64Array(beams),
    bearing: new Float32Array(beams),
    first: new Float32Array(beams),
    binLength: new Float32Array(beams).fill(binLength),
    echo: new Float32Array(beams),
    probability: new Float32Array(beams),
    threshold: new Float32Array(beams).fill(90),
    sweep: new Uint32Array(beams),
  };
  const intensities = new Uint8Array(beams * bins);
  for (let i = 0; i < beams; ++i) {
    const pose = vehicleAt(i / beams);
    columns.time[i] = startTime + i * beamSeconds;
    columns.bearing[i] = ((i % beamsPerTurn) / beamsPerTurn) * 2 * Math.PI;
    columns.sweep[i] = Math.floor(i / beamsPerTurn);
    const range = rangeTo(pose.x, pose.y, pose.heading + columns.bearing[i]);
    const isLost = i % 23 === 0;
    columns.echo[i] = isLost ? NaN : range;
    columns.probability[i] = isLost ? NaN : 0.8;
    for (let k = 0; k < bins; ++k) {
      const r = (k + 0.5) * binLength;
      const echo = isLost
        ? 0
        : 170 * Math.exp(-(((r - range) / 0.12) ** 2)) + (r > range ? 25 * Math.exp(-(r - range)) : 0);
      const ringing = 200 * Math.exp(-r / 0.15);
      intensities[i * bins + k] = Math.min(255, echo + ringing + 28 * random() + 10 * Math.exp(-r / 4));
    }
  }
  return { columns: answer([0x4c585650, beams, bins, 0], Object.values(columns)), intensities };
}

/** A tank with walls, a bottom and a floater, the way of a vehicle in it and what its sonar heard. */
export function tankScene() {
  const random = randomNumbers(1);
  const { resolution } = tank;
  const cells = new CellSet();
  const size = [tank.length, tank.width, tank.depth].map((metres) => Math.round(metres / resolution));
  const probability = () => 140 + Math.floor(110 * random());
  const shift = [0, 1].map((axis) => Math.round(origin[axis] / resolution));
  const put = (x, y, z) => cells.set(x + shift[0], y + shift[1], z, probability());
  for (let z = -size[2]; z < 0; ++z) {
    for (let x = 0; x < size[0]; ++x) for (const y of [0, size[1] - 1]) put(x, y, z);
    for (let y = 0; y < size[1]; ++y) for (const x of [0, size[0] - 1]) put(x, y, z);
  }
  for (let x = 0; x < size[0]; ++x) for (let y = 0; y < size[1]; ++y) put(x, y, -size[2]);
  const centre = [floater.x, floater.y, floater.z].map((metres) => metres / resolution);
  const radius = floater.radius / resolution;
  const inFloater = (x, y, z) => Math.hypot(x + 0.5 - centre[0], y + 0.5 - centre[1], z + 0.5 - centre[2]) < radius;
  for (let z = -size[2]; z < 0; ++z) {
    for (let x = 0; x < size[0]; ++x) for (let y = 0; y < size[1]; ++y) if (inFloater(x, y, z)) put(x, y, z);
  }
  // Cells between the thresholds: shown when the threshold is lowered.
  for (let x = 20; x < 30; ++x) for (let y = 20; y < 30; ++y) cells.set(x + shift[0], y + shift[1], -40, 110);
  const cubes = [];
  for (let z = -size[2] + 1; z < 0; ++z) {
    for (let x = 1; x + 1 < size[0]; ++x) {
      for (let y = 1; y + 1 < size[1]; ++y) {
        // A corner of the tank was not seen.
        if (x > size[0] - 40 && y < 30) continue;
        if (!cells.has(x + shift[0], y + shift[1], z)) cubes.push([x + shift[0], y + shift[1], z, 1]);
      }
    }
  }
  const poses = Array.from({ length: 200 }, (_, i) => ({
    time: startTime + (i / 199) * turns * beamsPerTurn * beamSeconds,
    ...vehicleAt(i / 199),
  }));
  const log = logAnswers();
  const pointCount = 400;
  const points = [0, 1, 2, 3].map((axis) =>
    Float32Array.from(
      { length: pointCount },
      (_, i) => [6.5 + Math.cos(i), 1 + 0.5 * Math.sin(i), -1 - i / pointCount, i][axis],
    ),
  );
  const scene = {
    title: "tank.bin",
    version: 1,
    unit: "m",
    axes: { x: "east", y: "north" },
    origin_m: origin,
    maps: [
      {
        id: 0,
        name: "tank.bt",
        format: "bt",
        resolution_m: resolution,
        occupancy: 0.5,
        bounds: {
          min: [...origin.slice(0, 2), -tank.depth],
          max: [origin[0] + tank.length, origin[1] + tank.width, 0],
        },
        occupied_cells: cells.count - 100,
        free_cells: cubes.length,
        cells: "map/0/cells",
        free: "map/0/free",
        agreement: "map/0/agreement",
      },
    ],
    paths: [{ id: 0, name: "slam.tum", poses: poses.length, url: "path/0", clock: "unix" }],
    points: [{ id: 0, name: "cloud.ply", count: pointCount, url: "points/0" }],
    logs: [
      {
        id: 0,
        name: "tank.bin",
        beams: turns * beamsPerTurn,
        bins,
        beam_width_deg: 3,
        beam_height_deg: 35,
        mount: { position: [0.2, 0, -0.1], quaternion: [0, 0, 0, 1] },
        path: 0,
        url: "log/0",
        intensities: "log/0/bins",
      },
    ],
    notes: ["one turn of the head takes 20 s, in which the vehicle goes 4 m"],
  };
  return {
    "scene.json": new TextEncoder().encode(JSON.stringify(scene)),
    "map/0/cells": cells.bytes(resolution),
    "map/0/free": freeBytes(cubes),
    "map/0/agreement": Uint8Array.from({ length: cells.count }, (_, i) => i % 256),
    "path/0": pathBytes(poses),
    "points/0": answer([0x58585650, pointCount, 1, 0], points),
    "log/0": log.columns,
    "log/0/bins": log.intensities,
  };
}

/** A rough sea floor with walls, of about so many cells. */
export function harbourScene(count) {
  const cells = new CellSet();
  const edge = Math.round(Math.sqrt(count / 1.45));
  const resolution = 0.1;
  const height = (x, y) =>
    Math.round(
      -80 +
        14 * Math.sin(x / 61) * Math.cos(y / 47) +
        5 * Math.sin(x / 9 + y / 13) +
        2 * Math.sin(x * 1.3) * Math.cos(y * 1.7),
    );
  for (let x = 0; x < edge; ++x) {
    for (let y = 0; y < edge; ++y) {
      const top = height(x, y);
      const wall = x % 401 < 2 || y % 523 < 2;
      cells.set(x, y, top, 150 + ((x * 7 + y * 13) % 100));
      if ((x + y) % 3 === 0) cells.set(x, y, top - 1, 160);
      if (wall) for (let z = top + 1; z < -50; ++z) cells.set(x, y, z, 200);
    }
  }
  const scene = {
    title: "harbour.bt",
    version: 1,
    unit: "m",
    axes: { x: "east", y: "north" },
    origin_m: [0, 0, 0],
    maps: [
      {
        id: 0,
        name: "harbour.bt",
        format: "bt",
        resolution_m: resolution,
        occupancy: 0.5,
        bounds: null,
        occupied_cells: cells.count,
        free_cells: 0,
        cells: "map/0/cells",
        free: "map/0/free",
        agreement: null,
      },
    ],
    paths: [],
    points: [],
    logs: [],
    notes: [],
  };
  return {
    "scene.json": new TextEncoder().encode(JSON.stringify(scene)),
    "map/0/cells": cells.bytes(resolution),
    "map/0/free": freeBytes([]),
  };
}
