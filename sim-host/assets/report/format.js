// Numbers as a reader expects them: a true minus, no digits that are noise, powers of ten written out.
"use strict";
const format = (() => {
  const raised = (n) => String(n).replace("-", "⁻").replace(/\d/g, (d) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[d]);
  const minus = (s) => s.replace("-", "−");
  const power = (v) => Math.floor(Math.log10(Math.abs(v)) + 1e-9);

  // With a power of ten behind it, where the plain form would be long.
  const scientific = (v, digits) => {
    const p = power(v);
    const mantissa = Number((v / 10 ** p).toFixed(digits));
    const front = mantissa === 1 ? "" : mantissa === -1 ? "−" : minus(String(mantissa)) + "×";
    return `${front}10${raised(p)}`;
  };

  // A tick of an axis whose ticks are `step` apart.
  const tick = (v, step) => {
    if (v === 0 || Math.abs(v) < step * 1e-6) return "0";
    if (Math.abs(v) >= 1e5 || step < 1e-4) return scientific(v, Math.max(0, power(v) - power(step)));
    const decimals = (String(Number(step.toPrecision(4))).split(".")[1] ?? "").length;
    return minus(v.toFixed(decimals));
  };

  // A tick of a logarithmic axis.
  const decade = (v) => (v >= 1e5 || v < 1e-3 ? scientific(v, 1) : String(Number(v.toPrecision(3))));

  // A value under the cursor, four significant digits.
  const value = (v) => {
    if (v == null || Number.isNaN(v)) return "–";
    if (v === 0) return "0";
    const p = power(v);
    if (p > 5 || p < -4) return scientific(v, 3);
    return minus(v.toFixed(Math.max(0, 3 - p)));
  };

  return { tick, decade, value };
})();
