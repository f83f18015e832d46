/** How wide texts are in the font that the reader's browser has for the page. */

import { palette } from "./palette";

const context = document.createElement("canvas").getContext("2d");

/** The widest of some texts, in pixels, as drawings write them: 11 pixels high. */
export function widest(texts: string[]): number {
  if (!context) return 0;
  context.font = `11px ${palette().font}`;
  return texts.reduce((most, text) => Math.max(most, context.measureText(text).width), 0);
}
