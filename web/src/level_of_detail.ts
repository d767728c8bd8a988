/** Which chunks of which level to draw: the finest that can be seen, within a number of faces. */

export interface DetailNode<Node> {
  children: readonly Node[];
  /** Whether there is something to draw it by. */
  ready: boolean;
  /** Faces that it has, or an estimate. */
  faces: number;
  level: number;
}

export interface Choice<Node> {
  draw: Node[];
  /** What is still to be made, the most visible first. */
  wanted: Node[];
  /** Whether all that should be seen is drawn as fine as it should be. */
  complete: boolean;
}

/**
 * @param cellPixels size of a node's cells on the screen; 0 outside of it
 * @param enoughPixels smaller cells are not refined
 */
export function chooseDetail<Node extends DetailNode<Node>>(
  roots: readonly Node[],
  cellPixels: (node: Node) => number,
  options: { enoughPixels: number; finestLevel: number; budget: number },
): Choice<Node> {
  const heap = new LargestFirst<Node>();
  const choice: Choice<Node> = { draw: [], wanted: [], complete: true };
  let faces = 0;
  for (const root of roots) {
    heap.push(root, cellPixels(root));
    faces += root.faces;
  }
  for (let top = heap.pop(); top; top = heap.pop()) {
    const { item: node, priority: pixels } = top;
    const isFine = node.level <= options.finestLevel || node.children.length === 0 || pixels <= options.enoughPixels;
    if (!isFine) {
      const more = node.children.reduce((sum, child) => sum + child.faces, -node.faces);
      if (faces + more <= options.budget) {
        const missing = node.children.filter((child) => !child.ready);
        if (missing.length === 0) {
          faces += more;
          for (const child of node.children) heap.push(child, cellPixels(child));
          continue;
        }
        if (node.ready) {
          choice.wanted.push(...missing);
          choice.complete = false;
        }
      }
    }
    if (node.ready) choice.draw.push(node);
    else {
      choice.wanted.push(node);
      choice.complete = false;
    }
  }
  return choice;
}

/** A binary heap. */
class LargestFirst<Item> {
  private readonly entries: { item: Item; priority: number }[] = [];

  push(item: Item, priority: number): void {
    const { entries } = this;
    let at = entries.length;
    entries.push({ item, priority });
    while (at > 0) {
      const parent = (at - 1) >> 1;
      if (entries[parent].priority >= priority) break;
      entries[at] = entries[parent];
      at = parent;
    }
    entries[at] = { item, priority };
  }

  pop(): { item: Item; priority: number } | undefined {
    const { entries } = this;
    const top = entries[0];
    const last = entries.pop();
    if (!last || entries.length === 0) return top;
    let at = 0;
    for (;;) {
      let child = 2 * at + 1;
      if (child >= entries.length) break;
      if (child + 1 < entries.length && entries[child + 1].priority > entries[child].priority) ++child;
      if (entries[child].priority <= last.priority) break;
      entries[at] = entries[child];
      at = child;
    }
    entries[at] = last;
    return top;
  }
}
