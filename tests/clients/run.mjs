// Runs the compiled clients against a daemon, in TAP lines. Usage: run.mjs BUILD
import { execFileSync } from 'node:child_process';

import { Daemon } from '../browser/daemon.mjs';

const build = process.argv[2], clients = ['types_client', 'sdk_client'];
const daemon = await new Daemon(build).start();
let failed = 0;
console.log(`1..${clients.length}`);
for (const [index, client] of clients.entries()) {
  try {
    const said = execFileSync('node', [`${build}/clients/out/${client}.js`, daemon.url], { encoding: 'utf8', timeout: 120000 });
    console.log(`# ${said.trim()}\nok ${index + 1} - ${client}`);
  } catch (fault) {
    failed = 1;
    console.log(`not ok ${index + 1} - ${client}: ${fault.message}`);
  }
}
await daemon.remove();
process.exit(failed);
