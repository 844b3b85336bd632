// A client by openapi-typescript and openapi-fetch: paths and documents are types.
import createClient from 'openapi-fetch';

import type { components, paths } from './generated/types';
import { assert, EXPECTED_LX, pause, ROOM, run } from './smoke';

type Result = components['schemas']['Result'];

run(async (url) => {
  const client = createClient<paths>({ baseUrl: url });
  const limits = await client.GET('/v1/limits');
  assert(limits.data!.views === 1024, 'limits');

  const files: components['schemas']['SceneFiles'] = { files: [{ name: 'room.rad', text: ROOM }] };
  const scene = await client.POST('/v1/scenes', { body: files });
  assert(scene.data !== undefined, 'the scene is refused');

  const body: components['schemas']['JobRequest'] = {
    kind: 'render', scene: scene.data.id, technique: 'backward', gather_samples: 64,
    sensors: [[1.5, 2, 0.8, 0, 0, 1]],
  };
  let job = (await client.POST('/v1/jobs', { body })).data!;
  const path = { id: job.id };
  while (job.state === 'queued' || job.state === 'running') {
    await pause(100);
    job = (await client.GET('/v1/jobs/{id}', { params: { path } })).data!;
  }
  assert(job.state === 'succeeded', `the job is ${job.state}`);
  const result = (await client.GET('/v1/jobs/{id}/result', { params: { path } })).data as Result;
  const lx = result.sensors[0].illuminance_lx!;
  assert(Math.abs(lx / EXPECTED_LX - 1) < 0.02, `${lx} lx instead of ${EXPECTED_LX}`);

  const wrong = await client.POST('/v1/jobs', { body: { ...body, gather_samples: -1 } });
  assert(wrong.error?.primitive === 'gather_samples', 'a wrong job has no problem');
  console.log(`${lx.toFixed(1)} lx; ${wrong.error.detail}`);
});
