"""What every episode shares: its records, diagnosis, routing, the correction loop and the monitor."""
