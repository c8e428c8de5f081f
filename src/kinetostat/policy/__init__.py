"""The policy: kinetostat.toml -> settings and expectations -> what a robot meets and what not."""
