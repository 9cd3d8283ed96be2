// Which way the axes of the frame that is shown point, also where its origin is not on the screen.
import { kAxes } from "../../cloud/surroundings";
import type { Vec2 } from "../../protocol";

const kLength = 26, kLetter = 34; // from the middle [px]

/// `towards`: each axis as it points on the screen, x right, y down, at most 1 long.
export function turnCompass(svg: SVGSVGElement, towards: Vec2[]): void {
  for (const [i, [x, y]] of towards.entries()) {
    const [line, letter] = svg.children[i].children;
    line.setAttribute("x2", (kLength * x).toFixed(1));
    line.setAttribute("y2", (kLength * y).toFixed(1));
    letter.setAttribute("x", (kLetter * x).toFixed(1));
    letter.setAttribute("y", (kLetter * y).toFixed(1));
  }
}

export function compassParts() {
  return kAxes.map(([name, color]) => (
    <g key={name} stroke={color} fill={color}><line stroke-width="2.5" /><text stroke="none">{name}</text></g>
  ));
}
