"""Occupancy and displacement of every shape on a tetrahedral grid.

Inputs: zips of repaired meshes and the catalogue. Outputs: one Zarr store a shard, and the index that opens
them as one data set, with the constants of the training split.
"""


rule extract_fields:
    input:
        meshes="<results>/data/{category}/{scatteritem}.zip",
    output:
        fields="<results>/fields/{category}/{grid}/{scatteritem}.zarr.zip",
    log:
        "<logs>/extract_fields/{category}/{grid}/{scatteritem}.log",
    benchmark:
        "<benchmarks>/extract_fields/{category}/{grid}/{scatteritem}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=fields_mem_mb,
    params:
        grid=section("grids", "{grid}"),
        code=code_digest("tetgan.fields.extraction:extract_shard"),
    shell:
        "tetgan extract-fields {input.meshes:q} {output.fields:q} --grid {params.grid:q} --threads {threads}"
        " >{log:q} 2>&1"


rule index_fields:
    input:
        fields=gather.shards(
            "<results>/fields/{{category}}/{{grid}}/{scatteritem}.zarr.zip"
        ),
        catalogue="<results>/data/{category}/catalogue.csv",
    output:
        index="<results>/fields/{category}/{grid}/index.json",
    log:
        "<logs>/index_fields/{category}/{grid}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=fields_mem_mb,
    params:
        grid=section("grids", "{grid}"),
        code=code_digest("tetgan.fields.store:index_fields"),
    shell:
        "tetgan index {input.fields:q} {output.index:q} --catalogue {input.catalogue:q}"
        " --grid {params.grid:q} >{log:q} 2>&1"
