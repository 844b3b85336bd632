-- What a job is estimated to take in memory, and how often the daemon has ended abruptly through
-- it. Until now every start that did not end well counted: those of jobs that wait or run still do.

ALTER TABLE jobs ADD COLUMN memory_bytes INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN strikes INTEGER NOT NULL DEFAULT 0;

UPDATE jobs SET strikes = max(0, attempts - 1) WHERE state IN ('queued', 'running');
