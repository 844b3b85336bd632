-- Which scenes jobs that wait or run need, without looking at every job that has ended.

CREATE INDEX jobs_under_way ON jobs (scene) WHERE state IN ('queued', 'running');
