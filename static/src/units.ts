/** Numbers in words an operator reads. */

export function metres(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  return Math.abs(value) >= 1000 ? `${(value / 1000).toFixed(2)} km` : `${value.toFixed(0)} m`;
}

const HECTARE_M2 = 1e4;
const SQUARE_KM_M2 = 1e6;

/** Square metres, from a tenth of a hectare on hectares, from ten square kilometres on these. */
export function squareMetres(value: number): string {
  if (value >= 10 * SQUARE_KM_M2) return `${(value / SQUARE_KM_M2).toFixed(2)} km²`;
  return value >= HECTARE_M2 / 10 ? `${(value / HECTARE_M2).toFixed(2)} ha` : `${value.toFixed(0)} m²`;
}

export function seconds(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value < 1) return `${(value * 1000).toFixed(0)} ms`;
  if (value < 60) return `${value.toFixed(1)} s`;
  const whole = Math.round(value);
  const h = Math.floor(whole / 3600);
  const m = Math.floor((whole % 3600) / 60);
  return h > 0 ? `${h} h ${m} min` : `${m} min ${whole % 60} s`;
}

export function percent(fraction: number | null | undefined, digits = 1): string {
  if (fraction === null || fraction === undefined || !Number.isFinite(fraction)) return "–";
  return `${(fraction * 100).toFixed(digits)} %`;
}

/** Rounded down, so that what is not whole never reads 100 %. */
export function percentDown(fraction: number | null | undefined): string {
  return percent(typeof fraction === "number" ? Math.floor(fraction * 1e4 + 1e-6) / 1e4 : fraction, 2);
}

/** A parameter's value: whole ones, flags too, without decimals. */
export function figure(value: number): string {
  return Number.isInteger(value) ? String(value) : value.toFixed(2);
}

export function number(value: number | null | undefined, digits = 1, unit = ""): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  return unit ? `${value.toFixed(digits)} ${unit}` : value.toFixed(digits);
}
