// Maps as MCAP, read by @mcap/core, protobufjs and Foxglove's reader of ROS 2's messages.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { McapIndexedReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { decompress } from "fzstd";
import protobuf from "protobufjs";
import descriptor from "protobufjs/ext/descriptor/index.js";
import { Workplace } from "./program.mjs";

let here;
let points;
before(() => {
  here = new Workplace();
  here.call("simulate", "tank", "-o", "tank.csv", "--seed", "1", "--turns", "1", "--beams-per-turn", "40");
  here.call("map", "tank.csv", "-o", "tank.ot", "--resolution", "0.1");
  here.call("convert", "tank.ot", "-o", "tank.xyz");
  here.write("dive.tum", "0.5 1.5 -2.25 -3 0 0 0.6 0.8\n1.5 2.5 -2.25 -3 0 0 0.6 0.8\n");
  points = here
    .read("tank.xyz")
    .toString()
    .split("\n")
    .filter((line) => line !== "")
    .map((line) => line.split(" ").map(Number));
});
after(() => here?.remove());

/** Messages of all topics, decoded. */
async function messagesOf(bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
  };
  const reader = await McapIndexedReader.Initialize({
    readable,
    decompressHandlers: { zstd: (data, size) => decompress(data, new Uint8Array(Number(size))) },
  });
  const decoders = new Map();
  const messages = {};
  for await (const { channelId, logTime, data } of reader.readMessages()) {
    const channel = reader.channelsById.get(channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    if (!decoders.has(channelId)) decoders.set(channelId, decoderOf(schema));
    (messages[channel.topic] ??= []).push({ logTime, schema: schema.name, value: decoders.get(channelId)(data) });
  }
  return { reader, messages };
}

function decoderOf(schema) {
  if (schema.encoding === "protobuf") {
    const root = protobuf.Root.fromDescriptor(descriptor.FileDescriptorSet.decode(schema.data));
    const type = root.lookupType(schema.name);
    return (data) => type.toObject(type.decode(data), { defaults: true, longs: Number });
  }
  const reader = new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true }));
  return (data) => reader.readMessage(data);
}

function floats(bytes) {
  return new Float32Array(new Uint8Array(bytes).buffer);
}

function isNear(a, b, limit = 1e-5) {
  assert.ok(Math.abs(a - b) <= limit, `${a} and ${b}`);
}

function arePoints(data) {
  assert.equal(data.length, points.length * 5);
  points.forEach((point, i) => point.forEach((number, k) => isNear(data[5 * i + k], number)));
}

test("Foxglove's messages hold the map, the path and the beams", async () => {
  here.call("convert", "tank.ot", "-o", "tank.mcap", "--path", "dive.tum", "--beams", "tank.csv");
  const { reader, messages } = await messagesOf(here.read("tank.mcap"));
  assert.equal(reader.header.profile, "");
  arePoints(floats(messages["/cloud"][0].value.data));

  // Each occupied cell is in one box.
  const cells = new Set();
  for (const topic of Object.keys(messages).filter((name) => name.startsWith("/voxels/"))) {
    const [{ schema, value }] = messages[topic];
    assert.equal(schema, "foxglove.VoxelGrid");
    assert.deepEqual(
      value.fields.map((field) => field.name),
      ["log_odds", "red", "green", "blue", "alpha"],
    );
    const corner = value.pose.position;
    const view = new DataView(new Uint8Array(value.data).buffer);
    for (let at = 0; at < view.byteLength; at += value.cell_stride) {
      if (view.getUint8(at + 7) === 0) continue;
      const x = (at % value.row_stride) / value.cell_stride;
      const y = Math.floor((at % value.slice_stride) / value.row_stride);
      const z = Math.floor(at / value.slice_stride);
      const middle = [corner.x + (x + 0.5) * 0.1, corner.y + (y + 0.5) * 0.1, corner.z + (z + 0.5) * 0.1];
      cells.add(middle.map((metres) => Math.floor(metres * 10 + 1e-6)).join(" "));
    }
  }
  const expected = new Set();
  for (const [x, y, z, , size] of points) {
    const first = [x, y, z].map((middle) => Math.round((middle - size / 2) * 10));
    const count = Math.round(size * 10);
    for (let i = 0; i < count ** 3; ++i) {
      const offset = [i % count, Math.floor(i / count) % count, Math.floor(i / count / count)];
      expected.add(first.map((cell, axis) => cell + offset[axis]).join(" "));
    }
  }
  assert.deepEqual([...cells].sort(), [...expected].sort());

  const [{ value: grid }] = messages["/grid"];
  assert.equal(grid.data.length % grid.row_stride, 0);
  assert.ok(grid.data.includes(100) && grid.data.includes(0) && grid.data.includes(255));
  assert.equal(messages["/path"][0].value.poses.length, 2);
  const transforms = messages["/tf"].filter(({ value }) => value.child_frame_id === "base_link");
  assert.equal(transforms.length, 2);
  assert.deepEqual(transforms[1].value.translation, { x: 2.5, y: -2.25, z: -3 });
  isNear(transforms[1].value.rotation.w, 0.8);
  assert.equal(transforms[1].logTime, 1500000000n);
  assert.equal(messages["/beams"].length, 40);
});

test("the messages of ROS 2 hold the same", async () => {
  here.call("convert", "tank.ot", "-o", "ros.mcap", "--messages", "ros2", "--path", "dive.tum", "--beams", "tank.csv");
  const { reader, messages } = await messagesOf(here.read("ros.mcap"));
  assert.equal(reader.header.profile, "ros2");
  for (const channel of reader.channelsById.values()) {
    assert.match(channel.metadata.get("offered_qos_profiles"), /^- history: 1\n {2}depth: /);
    assert.match(channel.metadata.get("topic_type_hash"), /^RIHS01_[0-9a-f]{64}$/);
  }
  arePoints(floats(messages["/octomap_point_cloud_centers"][0].value.data));
  for (const [topic, suffix] of [
    ["/octomap_binary", "bt"],
    ["/octomap_full", "ot"],
  ]) {
    here.call("convert", "tank.ot", "-o", `again.${suffix}`);
    const file = here.read(`again.${suffix}`);
    const [{ value }] = messages[topic];
    assert.equal(value.id, "OcTree");
    assert.equal(value.resolution, 0.1);
    assert.deepEqual(Buffer.from(value.data), file.subarray(file.indexOf("\ndata\n") + 6));
  }
  const [{ value: grid }] = messages["/projected_map"];
  assert.equal(grid.data.length, grid.info.width * grid.info.height);
  assert.equal(messages["/path"][0].value.poses[1].header.stamp.nanosec, 500000000);
  assert.equal(messages["/tf"].at(-1).value.transforms[0].transform.translation.x, 2.5);
  assert.equal(messages["/beams"].length, 40);
});
