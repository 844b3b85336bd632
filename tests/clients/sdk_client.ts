// A client by @hey-api/openapi-ts: each operation is a function.
import { getJob, getResult, limits, postJob, postScene } from './generated/sdk';
import { client } from './generated/sdk/client.gen';
import type { JobRequest, Result } from './generated/sdk';
import { assert, EXPECTED_LX, pause, ROOM, run } from './smoke';

run(async (url) => {
  client.setConfig({ baseUrl: url });
  assert((await limits()).data!.views === 1024, 'limits');

  const scene = await postScene({ body: { files: [{ name: 'room.rad', text: ROOM }] }, headers: { 'Content-Type': 'application/json' } });
  assert(scene.data !== undefined, 'the scene is refused');

  const body: JobRequest = {
    kind: 'render', scene: scene.data.id, technique: 'backward', gather_samples: 64,
    sensors: [[1.5, 2, 0.8, 0, 0, 1]],
  };
  let job = (await postJob({ body })).data!;
  const path = { id: job.id };
  while (job.state === 'queued' || job.state === 'running') {
    await pause(100);
    job = (await getJob({ path })).data!;
  }
  assert(job.state === 'succeeded', `the job is ${job.state}`);
  const result = (await getResult({ path })).data as Result;
  const lx = result.sensors[0].illuminance_lx!;
  assert(Math.abs(lx / EXPECTED_LX - 1) < 0.02, `${lx} lx instead of ${EXPECTED_LX}`);

  const wrong = await postJob({ body: { ...body, gather_samples: -1 } });
  assert(wrong.error !== undefined && wrong.error.primitive === 'gather_samples', 'a wrong job has no problem');
  console.log(`${lx.toFixed(1)} lx; ${wrong.error.detail}`);
});
