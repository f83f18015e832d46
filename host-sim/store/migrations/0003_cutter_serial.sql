-- The very cutter of a part, as the shop knows it: its size is expected of the next job.
ALTER TABLE part ADD COLUMN cutter_serial TEXT;
