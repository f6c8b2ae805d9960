"""What every subject stands on: jobs, operators, commands, choices. It knows no subject."""
