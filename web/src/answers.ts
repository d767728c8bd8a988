/** Answers of the program by relative URL, or those that an exported page carries in itself. */

async function inflate(base64: string): Promise<ArrayBuffer> {
  const text = atob(base64.trim());
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Response(stream).arrayBuffer();
}

/** Counts the bytes that came, as they are after decompression. */
export class Answers {
  received = 0;

  async bytes(url: string): Promise<ArrayBuffer> {
    const inline = document.getElementById(url);
    let bytes: ArrayBuffer;
    if (inline instanceof HTMLScriptElement) {
      bytes = await inflate(inline.textContent ?? "");
    } else {
      const response = await fetch(url);
      if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
      bytes = await response.arrayBuffer();
    }
    this.received += bytes.byteLength;
    return bytes;
  }

  async json<T>(url: string): Promise<T> {
    return JSON.parse(new TextDecoder().decode(await this.bytes(url))) as T;
  }

  /** Bytes [from, to) * length; an exported page has the whole, of which this is a part. */
  async rows(url: string, from: number, to: number, length: number): Promise<Uint8Array> {
    if (document.getElementById(url)) {
      this.whole ??= new Map();
      if (!this.whole.has(url)) this.whole.set(url, this.bytes(url));
      const bytes = await this.whole.get(url)!;
      return new Uint8Array(bytes, from * length, (to - from) * length);
    }
    return new Uint8Array(await this.bytes(`${url}?from=${from}&to=${to}`));
  }

  private whole?: Map<string, Promise<ArrayBuffer>>;
}
