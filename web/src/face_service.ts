/** The worker that makes faces: requests go out, answers come to those who asked. */
import type {
  Answer,
  FacesAnswer,
  FacesRequest,
  MapAnswer,
  MapRequest,
  SpaceAnswer,
  SpaceRequest,
} from "./faces_protocol";

export class FaceService {
  private readonly waiting: { resolve: (answer: Answer) => void; reject: (error: Error) => void }[] = [];

  constructor(private readonly worker: Worker) {
    // The worker answers in order.
    worker.onmessage = (event) => this.waiting.shift()?.resolve(event.data as Answer);
    worker.onerror = (event) => {
      event.preventDefault();
      this.waiting.shift()?.reject(new Error(event.message || "the worker failed"));
    };
  }

  ask(request: MapRequest): Promise<MapAnswer>;
  ask(request: FacesRequest): Promise<FacesAnswer>;
  ask(request: SpaceRequest): Promise<SpaceAnswer>;
  ask(request: MapRequest | FacesRequest | SpaceRequest): Promise<Answer> {
    return new Promise((resolve, reject) => {
      this.waiting.push({ resolve, reject });
      this.worker.postMessage(request);
    });
  }
}

/**
 * The page's own script is the worker's, too: served, by its address; in an exported page, where it stands in the
 * document, by a copy of its text.
 */
export function startWorker(script: HTMLScriptElement): Worker {
  if (script.src) return new Worker(script.src);
  const url = URL.createObjectURL(new Blob([script.textContent ?? ""], { type: "text/javascript" }));
  const worker = new Worker(url);
  URL.revokeObjectURL(url);
  return worker;
}
