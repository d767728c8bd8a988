/** The scale of colours with its values. */
import { scaleTable } from "./colours";
import { drawing, element, fixed, ticksBetween } from "./dom";

export function drawScale(): void {
  const canvas = element<HTMLCanvasElement>("legend-scale");
  const context = drawing(canvas);
  const image = context.createImageData(1, canvas.height);
  for (let y = 0; y < canvas.height; ++y) {
    const place = Math.round(255 * (1 - (y + 0.5) / canvas.height));
    image.data.set(scaleTable.subarray(4 * place, 4 * place + 4), 4 * y);
  }
  context.putImageData(image, 0, 0);
}

/** @param note what the scale does not have */
export function showLegend(title: string, from: number, to: number, note = ""): void {
  element("legend-title").textContent = title;
  element("legend-note").textContent = note;
  element("legend-note").hidden = note === "";
  const { values, digits } = ticksBetween(from, to, 5);
  element("legend-ticks").replaceChildren(
    ...values.map((value) => {
      const tick = document.createElement("li");
      tick.textContent = fixed(value, digits);
      tick.style.top = `${to > from ? 100 * (1 - (value - from) / (to - from)) : 50}%`;
      return tick;
    }),
  );
}
