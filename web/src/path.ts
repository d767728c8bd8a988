/** Where the vehicle was: the pose at a time, between those of a path. */
import { Quaternion, Vector3 } from "three";
import type { PathColumns } from "./scene";

export interface Pose {
  position: Vector3;
  attitude: Quaternion;
}

/** Index of the last entry that is not after `time`; 0 where all are. */
export function lastNotAfter(times: ArrayLike<number>, time: number): number {
  let low = 0;
  let high = times.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return low;
}

export function poseAt(path: PathColumns, time: number): Pose | null {
  if (path.time.length === 0) return null;
  const i = lastNotAfter(path.time, time);
  const k = Math.min(i + 1, path.time.length - 1);
  const span = path.time[k] - path.time[i];
  const part = span > 0 ? Math.min(Math.max((time - path.time[i]) / span, 0), 1) : 0;
  const attitude = attitudeOf(path, i);
  Quaternion.slerp(attitude.clone(), attitudeOf(path, k), attitude, part);
  return { position: pointOf(path, i).lerp(pointOf(path, k), part), attitude };
}

/** A path and the poses that follow its first ones. */
export function joinPaths(path: PathColumns, more: PathColumns): PathColumns {
  const join = <T extends Float32Array | Float64Array>(before: T, after: T): T => {
    const column = new (before.constructor as new (length: number) => T)(more.first + after.length);
    column.set(before.subarray(0, more.first) as T);
    column.set(after as T, more.first);
    return column;
  };
  return {
    version: more.version,
    first: 0,
    time: join(path.time, more.time),
    x: join(path.x, more.x),
    y: join(path.y, more.y),
    z: join(path.z, more.z),
    qx: join(path.qx, more.qx),
    qy: join(path.qy, more.qy),
    qz: join(path.qz, more.qz),
    qw: join(path.qw, more.qw),
  };
}

export function pointOf(path: PathColumns, i: number): Vector3 {
  return new Vector3(path.x[i], path.y[i], path.z[i]);
}

function attitudeOf(path: PathColumns, i: number): Quaternion {
  return new Quaternion(path.qx[i], path.qy[i], path.qz[i], path.qw[i]);
}

/** The pose of something that is mounted on the vehicle. */
export function mountedPose(vehicle: Pose, mount: { position: number[]; quaternion: number[] }): Pose {
  const [x, y, z] = mount.position;
  const [qx, qy, qz, qw] = mount.quaternion;
  return {
    position: new Vector3(x, y, z).applyQuaternion(vehicle.attitude).add(vehicle.position),
    attitude: vehicle.attitude.clone().multiply(new Quaternion(qx, qy, qz, qw)),
  };
}
