// What both clients are asked to do: read the limits, upload a room, render a sensor, and fail well.
// It has no types of the contract: each client checks those in its own program.

export const ROOM = `void plastic grey 0 0 5 .5 .5 .5 0 0
grey polygon floor 0 0 12 0 0 0 3 0 0 3 4 0 0 4 0
void glow sky_glow 0 0 4 10 10 10 0
sky_glow source sky 0 0 4 0 0 1 180
`;
// The sky has a radiance of 10 W/sr/m2 in each channel: an upward sensor has pi times 179 times that.
export const EXPECTED_LX = 10 * Math.PI * 179;

export function assert(holds: boolean, what: string): asserts holds {
  if (!holds) throw new Error(what);
}

export const pause = (ms: number) => new Promise((resolve) => setTimeout(resolve, ms));

export function run(client: (url: string) => Promise<void>) {
  client(process.argv[2]).catch((fault: unknown) => {
    console.error(fault);
    process.exit(1);
  });
}
